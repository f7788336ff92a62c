// The interface between the library and the shared object with OpenCASCADE in it, which is loaded only when a STEP file
// is written: core builds and runs without OpenCASCADE (libraries of their own, licence LGPL 2.1).
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

// A solid or a face: see shapes/shape_solids.h.
struct StepShape {
    enum class Form : std::uint32_t { face, frustum, ball, ring };
    Form form;
    const char* name;            // UTF-8
    double colour[3];            // red, green and blue as screens have them, 0 to 1
    double place[3];             // a point of the plane, the base, the centre
    double axis[3], zero[3];     // unit vectors across each other
    double radius, second;       // a frustum's two radii, a ring's circle and tube
    double length, arc;          // a frustum's; a ring's, radians
    const double (*corners)[3];  // a face's
    std::size_t corner_count;
};

// The unit of lengths. Numbers are not converted.
struct StepUnit {
    const char* name;  // as OpenCASCADE calls it: M, MM, CM, FT, INCH
    double millimetres;
};

// What is written goes to `append`, piece by piece; false ends the writing. Text is UTF-8, which STEP files have
// otherwise. Functions that fail return false and write a text to `message`, which has room for step_message_bytes, and
// the index of the shape that cannot be made, if it is one, to `shape`. One thread.
struct StepFunctions {
    std::uint32_t version;
    bool (*write)(const StepShape* shapes, std::size_t count, const char* title, const StepUnit* unit,
                  bool (*append)(void* to, const char* bytes, std::size_t size), void* to, std::size_t* shape,
                  char* message);
};

inline constexpr std::uint32_t step_module_version = 1;
inline constexpr std::size_t step_message_bytes = 256;

// The one symbol of the shared object: see system/shared_module.h.
inline constexpr const char* step_module_symbol = "pcm_step_functions";

}  // namespace pcm
