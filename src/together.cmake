# Sources that are compiled as one where G3R_TOGETHER is on: what many of them instantiate of the standard library and of Eigen is compiled
# once. No two of a group have a name of their own in common (of functions the compiler would not tell: it takes them for overloads). A
# source that is in no group is compiled by itself.
function(g3r_together group)
  list(TRANSFORM ARGN REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/\\1.cpp" OUTPUT_VARIABLE sources)
  set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
endfunction()
set_target_properties(g3r PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)

g3r_together(cloud cloud/canonical_cloud cloud/chance cloud/clusters cloud/exact_plane cloud/far_points cloud/neighbours cloud/plane_fit cloud/point_set
             cloud/quadratic_patch cloud/spacing tree/octree tree/far_pairs tree/interaction_lists tree/traversal tree/tree_parts
             expansions/expansions sum/direct_sum)
g3r_together(layers cloud/layers cloud/noise expansions/m2l_matrices sum/sum_plan solve/green_system solve/refine metrics/sample_mesh
             cloud/viewpoint cloud/wires solve/part_system)
g3r_together(sums cloud/outliers sum/fast_sum sum/solve_on_device sum/sum_engine sum/sum_geometry sum/sum_passes sum/target_shells
             solve/energy_system solve/harmonics baselines/baseline baselines/gauss_system baselines/hard_cutoff baselines/near_pairs
             baselines/stretched_winding baselines/wnnc field/areas)
g3r_together(solvers cloud/sites solve/dense_solver solve/iterative_solver field/field field/oriented_cloud field/winding_sampler
             metrics/score_mesh metrics/score_normals orient/confidence orient/memory_plan orient/noise_settings cloud/heights
             orient/crowded orient/open_to_views orient/sight_normals orient/two_walls orient/walls)
g3r_together(orient sum/device_scope metrics/triangle_tree orient/certificate orient/coarse_to_fine orient/creases orient/planes
             orient/polish orient/problem orient/sign_graph orient/solution orient/clean_surface orient/noisy_surface orient/solve_apart
             orient/solve_on_sites)
g3r_together(steps orient/facets orient/hints orient/apply_hints orient/closed_sides orient/patch_sides orient/votes orient/steps names
             reconstruct c_api orient/clustered_polish orient/projection orient/same_side orient/unsure)
g3r_together(jets orient/jets orient/agreement orient/certified_sides orient/open_surfaces orient/restless orient/site_parts pipeline orient/assess
             orient/attempt orient/callers_order orient/describe orient/noise_choice orient/outlier_normals orient/outside orient/separate_walls)

g3r_together(fields mesh/automatic_depth mesh/box_tree mesh/carry_attributes mesh/check_mesh mesh/component_support mesh/crossings mesh/edge_collapse
             mesh/exact_orientation mesh/field_contour mesh/field_corners mesh/field_denoise mesh/field_mesher mesh/field_octree
             mesh/trim)
g3r_together(fair mesh/fair mesh/field_local_fit mesh/field_placement mesh/field_labellings mesh/field_triangulate mesh/findings
             mesh/handle_removal mesh/held_points mesh/mesh_finish mesh/mesh_parts mesh/open_edges mesh/side_smoothing mesh/field_arcs
             mesh/least_squares_mesh mesh/local_surface mesh/mesh_memory)
g3r_together(trim mesh/field_points mesh/self_intersections mesh/separate_vertices mesh/simplify mesh/smooth_rims mesh/smooth_spacing
             mesh/split_nonmanifold mesh/untangle mesh/used_vertices mesh/point_parts mesh/regained_points)

g3r_together(parts_of_readers io/cloud_from_table io/columns io/copc io/decimal_steps io/fixed_records io/grid_header io/gzip io/json io/lzf
             io/merger io/number_type io/output_file io/ply_header io/ply_types io/point_stream io/polygons io/rows base/control_groups)
g3r_together(readers io/las io/las_fields io/las_plan io/point_text io/random_file io/read io/read_ascii_grid io/read_gltf io/read_las
             io/read_npy io/read_obj io/read_off io/read_pcd io/read_ply io/read_ptx io/splats)
g3r_together(splats io/read_spz io/read_xyz io/recognise io/source io/splat_light io/splat_view io/subset io/table
             io/text io/write io/write_npy io/write_obj)
g3r_together(writers io/column_facts io/column_names io/read_stl io/text_values io/tiles io/utf8 io/write_glb io/write_off
             io/write_pcd io/write_ply io/write_stl io/write_xyz io/xml)

g3r_together(tiles tiles/cells tiles/external_sort tiles/merge tiles/mesh_corners tiles/mesh_parts tiles/mesh_points tiles/mesh_records
             tiles/mesh_region tiles/mesh_run tiles/mesh_patches tiles/mesh_surroundings tiles/parts tiles/coarse_sides)
g3r_together(plans tiles/mesh_merge tiles/plan tiles/point_writer tiles/run tiles/patches_file tiles/spacing_sample tiles/tile_cloud)
g3r_together(pictures view/scene view/png view/canvas view/picture view/pack)
g3r_together(devices gpu/cuda gpu/device gpu/drivers gpu/execution gpu/kernel_cache gpu/kernel_source gpu/lists_on_device
             gpu/neighbours_on_device gpu/sum_on_device gpu/vectors_on_device)

# With nlohmann's JSON.
g3r_together(documents report io/ept io/file_lists tiles/manifest view/page)
g3r_together(lists io/ept_cells tiles/mesh_plan)

# What has names in common with one of those above.
g3r_together(headers gpu/opencl io/find_columns io/float_text io/gltf_file io/npy_header io/pcd_header io/ply_body io/write_las_new)
g3r_together(grounds gpu/nvrtc io/ptx_scans io/write_las mesh/coarsen mesh/corner_groups mesh/lines mesh/patch_components orient/noisy_jets
             orient/settings)
