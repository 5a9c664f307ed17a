// Options that several commands share, in groups, as --help shows them.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "settings.h"

namespace g3r::cli {

void add_threads_option(CLI::App& app, Settings& s);   ///< --threads
void add_device_option(CLI::App& app, Settings& s);    ///< --device
void add_console_options(CLI::App& app, Settings& s);  ///< --quiet, --no-progress, --verbose
void add_run_options(CLI::App& app, Settings& s);      ///< all of these
void add_report_options(CLI::App& app, Settings& s);   ///< --report, --strict
void add_seed_option(CLI::App& app, Settings& s);
void add_read_options(CLI::App& app, Settings& s);        ///< --min-opacity, --all-splats, --box, --levels
void add_write_options(CLI::App& app, Settings& s);       ///< --ascii
void add_confidence_options(CLI::App& app, Settings& s);  ///< --cloud-compare-names
void add_also_option(CLI::App& app, Settings& s);
void add_mesh_options(CLI::App& app, Settings& s);          ///< --mesher, --depth
void add_component_options(CLI::App& app, MeshOptions& o);  ///< --keep-largest, --min-component, --keep-all
void add_finish_options(CLI::App& app, Settings& s);        ///< --trim, --open, --faces, and those of components
void add_method_options(CLI::App& app, Settings& s);        ///< --preset to --condition-number
void add_memory_option(CLI::App& app, Settings& s, const std::string& help);
void add_hint_options(CLI::App& app, Settings& s);  ///< --up, --sensor, --inside, --seen-from-inside, --flip

}  // namespace g3r::cli
