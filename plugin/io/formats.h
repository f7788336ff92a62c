// The formats of point clouds as MeshLab lists them.
#pragma once

#include <common/interfaces.h>

#include <filesystem>
#include <string>

namespace pcm::host {

QList<MeshIOInterface::Format> import_formats();
QList<MeshIOInterface::Format> export_formats();

// Whether the extension, lower case, is one of text files, whose layout can be said by the user.
bool has_text_layout(const std::string& extension);

// Whether a file, readable by us by its extension, is a cloud: false for a PLY with anything beside its vertices and
// for the PTS of Expe, which MeshLab reads itself. A file that cannot be read is taken for a cloud, so that our reader
// says what is wrong with it.
bool is_cloud(const std::filesystem::path& file);

}  // namespace pcm::host
