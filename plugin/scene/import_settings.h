// Settings of the import: persistent ones in Tools > Options, and those of one file in the dialog before it is opened.
//
// MeshLab shows the dialog whenever a file has parameters, and opens the file with them even if the dialog is
// cancelled. So by default only text files have parameters, because a user may have to specify their layout.
// meshlabserver shows no dialog and reads no saved settings: the defaults apply.
#pragma once

#include "plugin/scene/parameters.h"

#include "pcm/io/text/text_layout.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pcm::host {

struct ImportSettings {
    std::uint64_t largest_layer = 1'000'000;   // a cloud of more points becomes a tree
    bool draw_layers = true;                   // a smaller one gets a drawn copy (meshlab/drawn_copy.h)
    std::filesystem::path tree_folder;         // where these trees are written; empty: next to the file
    bool may_build_beside = true;              // false: a tree next to the file is used, and none is written there
    std::optional<double> largest_coordinate;  // points beyond it are left out
    TextLayout text;                           // as far as the user has specified it
    bool skip_bad_lines = false;               // in text files
};

// The persistent ones, for Tools > Options.
void add_global_settings(Parameters& parameters);
void ask_always(Parameters& globals);  // those for one file are asked for whatever it is

// Those for one file; none if no dialog is to be shown. A file that does not exist stands for all with its extension.
// `globals`: the persistent settings, which are the defaults.
void add_file_settings(Parameters& parameters, const std::filesystem::path& file, const Parameters& globals);

// From the parameters that the program gives when it opens a file. Those of the file take precedence over the
// persistent ones. Throws Error(invalid_argument) for invalid columns.
ImportSettings read_import_settings(const Parameters& parameters);

}  // namespace pcm::host
