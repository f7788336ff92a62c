// How operations show primitives, and keep them in lists.
#pragma once

#include "pcm/ops/result.h"
#include "pcm/piping/pipe_run.h"
#include "pcm/shapes/primitive.h"

#include <filesystem>
#include <string>

namespace pcm::ops {

// All of it, as in a list (cad/primitive_files.h).
Json json_of(const Primitive& primitive);
// Parameters with their standard deviations, bounds, and how good the fit is.
void put_lines(Result& result, const Primitive& primitive);
// Pipe runs as pipe_runs_help describes them.
Json json_of(const std::vector<PipeRun>& runs);
inline constexpr const char* pipe_runs_help =
    "pipes and elbows that continue each other: name, parts (names), radius, sigma_radius (null: not known), length, "
    "sigma_length (null: not known), "
    "is_closed, doubt (empty: none), line: pieces with from, to and measured; bends with angle, radius, centre and "
    "axis";
// Name, parts, and the numbers in the unit, which may be empty.
void put_lines(Result& result, const PipeRun& run, const std::string& unit);
// What --registration of a fit and of a detection is.
inline constexpr const char* registration_help =
    "Standard deviation of how far a scanner's station is shifted along each axis after the registration, "
    "as its report states it: the standard deviations of the shape (+-) then contain it. Without a unit of "
    "length a cloud's coordinates are taken to be metres. Where points say from which station they are (an "
    "attribute scan or point_source_id, gaps in gps_time) it is found from surfaces that several see, and "
    "the larger one counts. Errors along the rays of a scanner, which turn thin pipes thinner, are taken "
    "from the shape, and what may be left of them is in the +-, too";
// The area of a plane with an outline: "52.1 +- 3.2 in the concave outline of its points".
std::string area_text(const Primitive& primitive);

// Throws Error(invalid_argument) unless the file's name ends in .json, and what read_primitives() throws for an
// existing file that is not a list: before the work, not after it.
void check_list(const std::filesystem::path& file);
// Writes the list with the primitive added, which gets a colour, and a name unless it has one; a list that does not
// exist is made. Processes that add to one list at once wait for each other (system/update_file.h). Throws what
// check_list(), json_of() and update_file() throw.
void add_to_list(const std::filesystem::path& file, Primitive& primitive);

}  // namespace pcm::ops
