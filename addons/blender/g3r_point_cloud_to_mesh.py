"""Add-on for Blender: Object > Point Cloud to Mesh makes a closed mesh of the points of the active object, by the Python package g3r.

It takes the vertices of a mesh or the points of a point cloud, as modifiers leave them and at the scale that is seen. The new object has the
name, the transform and the colours of these. docs/integrations.md says how to install it.
"""

import sys

import bpy
import numpy as np

bl_info = {
    "name": "Point Cloud to Mesh (g3r)",
    "description": "A closed mesh of the points of an object, which need no normals",
    "author": "the g3r authors",
    "version": (0, 2, 0),
    "blender": (4, 2, 0),
    "location": "Object > Point Cloud to Mesh",
    "category": "Object",
}


class OBJECT_OT_point_cloud_to_mesh(bpy.types.Operator):
    """Make a closed mesh of the points of the active object"""

    bl_idname = "object.g3r_point_cloud_to_mesh"
    bl_label = "Point Cloud to Mesh"
    bl_options = {"REGISTER", "UNDO"}

    open: bpy.props.BoolProperty(name="Open", description="The scan has no back side: cut away surface that is far from every point")
    noise: bpy.props.StringProperty(
        name="Noise", default="auto",
        description="How far the points scatter about the surface: auto, a length in the unit of the scene, 0.5% of the diagonal, "
        "1h (point spacings), 0 (they do not)")
    depth: bpy.props.IntProperty(name="Depth", min=0, max=12, description="Depth of the octree, from 4 on; 0: as the points allow")
    faces: bpy.props.IntProperty(name="Faces", min=0, description="Simplify to about so many triangles; 0: do not")

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.object is not None and context.object.type in {"MESH", "POINTCLOUD"}

    def execute(self, context):
        try:
            import g3r
        except ImportError as error:
            self.report({"ERROR"}, f"The Python package g3r cannot be loaded ({error}): install its wheel with "
                        f"{sys.executable} -m pip install --no-deps WHEEL; docs/integrations.md says where it comes from")
            return {"CANCELLED"}
        source = context.object
        points, color_name, colors = points_of(source.evaluated_get(context.evaluated_depsgraph_get()))
        try:
            result = g3r.run(points, colors=colors, trim="auto" if self.open else None, noise=self.noise, depth=self.depth or "auto",
                             faces=self.faces)
        except (g3r.Error, MemoryError) as error:
            self.report({"ERROR"}, str(error) or "Not enough memory")
            return {"CANCELLED"}
        target = bpy.data.objects.new(f"{source.name}.mesh", bpy.data.meshes.new(f"{source.data.name}.mesh"))
        target.matrix_world = source.matrix_world
        fill(target, result, color_name)
        (source.users_collection or [context.collection])[0].objects.link(target)
        for selected in context.selected_objects:
            selected.select_set(False)
        target.select_set(True)
        context.view_layer.objects.active = target
        for warning in result.stats["warnings"]:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"{len(result.faces):,} triangles, {'closed' if result.stats['mesh']['closed'] else 'not closed'}")
        return {"FINISHED"}


def points_of(source):
    """The points in the scene, (n, 3) in double; the name of their colours and these, (n, 3) shares of 1, or None and None."""
    attributes = source.data.attributes
    local = np.empty((len(attributes["position"].data), 3), np.float32)
    attributes["position"].data.foreach_get("vector", local.ravel())
    points = transformed(local, source.matrix_world)
    for attribute in attributes:
        if attribute.domain == "POINT" and attribute.data_type in {"FLOAT_COLOR", "BYTE_COLOR"}:
            rgba = np.empty((len(points), 4), np.float32)
            attribute.data.foreach_get("color_srgb", rgba.ravel())
            return points, attribute.name, np.clip(rgba[:, :3], 0, 1)  # colours that shine are above 1
    return points, None, None


def fill(target, result, color_name):
    """The mesh of the result, which is in the scene, becomes that of an object with a transform."""
    # The basis is what the object keeps: without the shear that parents may have given to the world matrix of the source.
    basis = target.matrix_basis
    vertices = transformed(result.vertices, basis.inverted_safe())
    faces = result.faces[:, ::-1] if basis.is_negative else result.faces  # a mirror turns triangles over
    target.data.from_pydata(vertices, [], faces)
    if color_name is not None:
        rgba = np.ones((len(vertices), 4), np.float32)
        rgba[:, :3] = result.vertex_colors / np.float32(255)
        attribute = target.data.color_attributes.new(color_name, "BYTE_COLOR", "POINT")
        attribute.data.foreach_set("color_srgb", rgba.ravel())
    target.data.update()


def transformed(points, matrix):
    matrix = np.array(matrix, np.float64)
    return points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def draw_entry(menu, _):
    menu.layout.operator(OBJECT_OT_point_cloud_to_mesh.bl_idname)


def register():
    bpy.utils.register_class(OBJECT_OT_point_cloud_to_mesh)
    bpy.types.VIEW3D_MT_object.append(draw_entry)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_entry)
    bpy.utils.unregister_class(OBJECT_OT_point_cloud_to_mesh)
