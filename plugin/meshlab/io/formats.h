// The formats of point clouds as the program lists them: those of the table in pcm/io/formats.h, and trees.
#pragma once

#include <QString>

#include <vector>

namespace pcm::host {

struct FileType {
    QString label;      // "LAZ compressed LAS"
    QString extension;  // "LAZ"
};
std::vector<FileType> import_formats();
std::vector<FileType> export_formats();

}  // namespace pcm::host
