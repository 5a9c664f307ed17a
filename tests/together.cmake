# Tests that are compiled as one program where G3R_TOGETHER is on, as the library is (src/together.cmake): what they instantiate of the
# standard library, of Eigen and of GoogleTest is compiled once, and one program is linked. Each is a test of ctest of its own all the same,
# and runs in a process of its own. No two of a group have a name of their own in common; a test that needs more than g3r_test() gives, or
# has no group, is a program by itself.
set(programs "")
function(g3r_tests_together program)
  list(TRANSFORM ARGN APPEND _test)
  set(names_of_${program} ${ARGN} PARENT_SCOPE)
  set(programs ${programs} ${program} PARENT_SCOPE)
endfunction()

g3r_tests_together(tests_of_quality areas baselines coarse_start field given_noise green_identity invariance open_surfaces orient outliers
                                    plan planes reconstruct sides_under_noise)
g3r_tests_together(tests_of_noise layers noise noise_settings noisy_jets projection same_side viewpoint walls)
g3r_tests_together(tests_of_attempts agreement assess attempt callers_order certified_sides clean_surface describe noise_choice noisy_surface
                                     outlier_normals outside problem restless separate_walls site_parts solution solve_apart solve_on_sites)
g3r_tests_together(tests_of_clouds canonical_cloud certificate chance clusters clustered_polish confidence crowded disk_sample exact_plane far_points jets hints closed_sides patch_sides
                                   votes morton neighbours open_to_views over_others plane_fit point_set quadratic_patch separate_vertices sight_normals sites spacing two_layers two_walls unsure)
g3r_tests_together(tests_of_sums adjoint coarse_to_fine dense_solver energy_system fast_sum harmonics heights iterative_solver memory_plan part_system polish refine
                                 pair_sums scattered_planes settings sign_graph tree)
g3r_tests_together(tests_of_meshes coarsen edge_collapse fair field_arcs field_mesher field_scenes)
g3r_tests_together(tests_of_parts field_contour handle_removal mesh_finish mesh_memory mesh_report point_parts)
g3r_tests_together(tests_of_shapes check_mesh metrics self_intersections split_nonmanifold untangle)
g3r_tests_together(tests_of_fields crossings expansions facets field_denoise field_local_fit findings held_points scanner_files)
g3r_tests_together(tests_of_files any_size ascii_grid base io_read io_write las_plan names platform splat_light table utf8 xml)
g3r_tests_together(tests_of_counted io_sweep point_stream tiles tiles_mesh)
