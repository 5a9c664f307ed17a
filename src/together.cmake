# Sources that are compiled as one where G3R_TOGETHER is on: what many of them instantiate of the standard library and of Eigen is compiled
# once. No two of a group have a name of their own in common (of functions the compiler would not tell: it takes them for overloads). A
# source that is in no group is compiled by itself. So is cloud/heights: what it instantiates of Eigen the compiler would look through for
# all that solve/dense_solver does.
function(g3r_together group)
  list(TRANSFORM ARGN REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/\\1.cpp" OUTPUT_VARIABLE sources)
  set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
endfunction()
set_target_properties(g3r PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)

g3r_together(cloud cloud/blocked_sights cloud/canonical_cloud cloud/chance cloud/clusters cloud/disk_sample cloud/exact_plane
             cloud/far_points cloud/morton cloud/neighbours cloud/noise cloud/outliers cloud/plane_fit cloud/point_set cloud/quadratic_patch cloud/site_planes cloud/sites
             cloud/spacing cloud/surface_distance cloud/viewpoint cloud/wires
             expansions/expansions expansions/m2l_matrices metrics/sample_mesh metrics/score_mesh metrics/score_normals
             metrics/triangle_tree tree/far_pairs tree/interaction_lists tree/octree tree/traversal tree/tree_parts)
g3r_together(sums gpu/cuda gpu/device gpu/drivers gpu/execution gpu/kernel_cache gpu/kernel_source gpu/lists_on_device
             gpu/neighbours_on_device gpu/sum_on_device gpu/vectors_on_device solve/energy_system sum/device_scope sum/direct_sum
             sum/fast_sum sum/solve_on_device sum/sum_engine sum/sum_geometry sum/sum_passes sum/sum_plan sum/target_shells)
g3r_together(solve baselines/baseline baselines/gauss_system baselines/hard_cutoff baselines/near_pairs baselines/stretched_winding
             baselines/wnnc cloud/layers cloud/two_layers field/areas field/field field/oriented_cloud field/points_with_normals
             field/surface_points field/winding_sampler solve/dense_solver solve/green_system solve/harmonics solve/iterative_solver
             solve/part_system solve/refine)
g3r_together(orient orient/attempt orient/clean_surface orient/clustered_polish orient/coarse_to_fine orient/jets
             orient/known_open orient/noise_choice orient/noise_settings orient/noisy_jets orient/noisy_surface orient/open_surfaces orient/outlier_normals
             orient/planes orient/polish orient/problem orient/projection orient/restless orient/settings orient/site_parts orient/solution
             orient/solve_apart orient/solve_on_sites orient/steps)
g3r_together(sides c_api describe_mesh mesh_run names orient/agreement orient/apply_hints orient/assess orient/callers_order
             orient/certificate orient/certified_sides orient/closed_sides orient/confidence orient/crowded orient/describe
             orient/facet_normals orient/facets orient/hints
             orient/memory_plan orient/open_to_views orient/outside orient/over_others orient/patch_sides orient/same_side orient/sensor_trust
             orient/separate_walls orient/sight_normals orient/sign_graph orient/two_walls orient/unsure orient/votes orient/walls pipeline reconstruct)
g3r_together(fields mesh/automatic_depth mesh/box_tree mesh/component_support mesh/corner_groups mesh/field_arcs mesh/field_contour
             mesh/field_corners mesh/field_denoise mesh/field_labellings mesh/field_local_fit mesh/field_mesher mesh/field_octree
             mesh/field_placement mesh/field_points mesh/field_triangulate mesh/handle_removal mesh/held_points mesh/least_squares_mesh
             mesh/lines mesh/local_surface mesh/mesh_memory mesh/open_edges mesh/patch_components mesh/point_parts mesh/regained_points
             mesh/side_smoothing)
g3r_together(meshes mesh/carry_attributes mesh/check_mesh mesh/coarsen mesh/crossings mesh/edge_collapse mesh/exact_orientation mesh/fair
             mesh/findings mesh/mesh_finish mesh/mesh_parts mesh/self_intersections mesh/separate_vertices mesh/simplify mesh/smooth_rims
             mesh/smooth_spacing mesh/split_nonmanifold mesh/trim mesh/untangle mesh/used_vertices)
g3r_together(readers io/column_words io/copc io/find_columns io/gltf_file io/las io/las_column io/las_coordinates io/las_extra_bytes
             io/las_fields io/las_plan io/npy_header io/ply_body io/ply_header io/ply_types io/point_lines io/point_rows io/random_file
             io/read io/read_ascii_grid io/read_gltf io/read_las io/read_npy io/read_obj io/read_off io/read_ply io/read_ptx io/read_spz
             io/recognise io/source io/splats io/strangers io/text io/text_numbers io/text_shape)
g3r_together(tables io/cloud_from_table io/column_facts io/column_names io/columns io/decimal_steps io/fixed_records io/grid_header io/gzip
             io/json io/lzf io/merger io/number_type io/output_file io/pcd_header io/point_stream io/polygons io/ptx_scans io/read_pcd
             io/read_stl io/read_xyz io/rows io/subset io/table io/tiles)
g3r_together(writers io/float_text io/splat_image io/splat_light io/splat_view io/text_values io/utf8 io/write io/write_glb io/write_las
             io/write_las_new io/write_npy io/write_obj io/write_off io/write_pcd io/write_ply io/write_stl io/write_xyz io/xml io/xml_text)
g3r_together(tiles base/control_groups gpu/nvrtc tiles/cells tiles/coarse_sides tiles/external_sort tiles/inputs tiles/merge
             tiles/mesh_corners tiles/mesh_parts tiles/mesh_patches tiles/mesh_points tiles/mesh_records tiles/mesh_region tiles/mesh_run
             tiles/mesh_surroundings tiles/parts tiles/patches_file tiles/plan tiles/point_writer tiles/run tiles/spacing_sample
             tiles/survey tiles/thinned tiles/tile_cloud tiles/tile_memory)
g3r_together(pictures gpu/opencl view/canvas view/pack view/picture view/png view/scene)

# With nlohmann's JSON. Its parser is compiled for every type of text: these parse string views.
g3r_together(documents io/ept io/ept_cells io/file_lists report tiles/manifest tiles/mesh_merge tiles/mesh_plan view/page)
