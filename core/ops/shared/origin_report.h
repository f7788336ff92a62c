// What the metadata of a cloud state about its coordinates and its file, as text and as JSON.
#pragma once

#include "pcm/cloud/metadata.h"
#include "pcm/ops/result.h"

#include <vector>

namespace pcm::ops {

// "crs": the coordinate system, null where none is stated; "gps_time", null likewise; "las": the header of the file
// that the cloud comes from, where it is one LAS file.
void put_origin(Json& json, const std::vector<Metadata>& metadata);
void print_origin(Result& result, const std::vector<Metadata>& metadata);

}  // namespace pcm::ops
