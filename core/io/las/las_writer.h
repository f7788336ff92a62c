// Writes LAS 1.0 to 1.4, point formats 0 to 10, and LAZ.
#pragma once

#include "pcm/io/survey.h"
#include "pcm/io/writer.h"

namespace pcm {

// A cloud from open_las() is written so that it reads back the same: positions, attributes with their types and names,
// grid, VLRs and EVLRs, and the header's version, file source id, GPS time type, GUID, system identifier, generating
// software and date. The point format is that of the source if the cloud still has its fields; otherwise the one with
// fields for the maximum number of attributes, and the smallest among those. Every other attribute becomes extra bytes,
// which readers take from any version; "normal" x 3 those of the names NormalX, NormalY and NormalZ, as other programs
// have it. The version is options.las_version, or the source's, or the lowest from 1.2 on that has the point format;
// 1.4 where there are extended VLRs, a coordinate system in WKT or more than 4,294,967,295 points. What a version asked
// for has no room for is named in notes(), or an error.
//
// Where a field has the name of an attribute but another type (float intensity, float colours) or too few bits (classes
// above 31), the attribute becomes extra bytes NAME_exact, from which open_las() restores it, and the field holds it
// rounded, for other software: colours and intensities of floats 0..1 times 65535, or of whatever range options.survey
// found. Numbers of a smaller type are stored in the field unchanged, 8-bit colours times 257. Points without returns
// are return 1 of 1. Without a survey, values that need more than a field's few bits (return_number, ...) are clamped
// to the largest and counted in notes(). Degrees in scan_angle go to scan_angle_rank too where the point format has
// that, and back.
//
// Positions are on options.grid, else on the cloud's grid: integers of the same grid are copied, other numbers are
// rounded to the nearest (position_error()). Points with a NaN or infinite coordinate are left out and counted in
// notes(). Throws Error(invalid_argument) for a cloud without a grid when none is given, and from write() for a
// coordinate that does not fit 32 bits on the grid.
//
// Not copied, and named in notes(): the octree of a cloud optimised file (user id copc), the index of LAStools,
// waveforms. The same points give the same bytes on any day and with any number of threads. The extension "laz" is
// compressed in chunks of 50000 points on options.threads threads, which needs the decoders (core/decoders) in the
// build; any other extension is LAS.
std::unique_ptr<PointWriter> create_las(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options = {});
SurveyQuestions las_questions(const FileInfo& cloud, const WriteOptions& options);

}  // namespace pcm
