// Drawings for CAD programs: DXF, the version of AutoCAD 2000 (AC1015), which all of them read.
//
// Written by dxflib, but for its numbers: coordinates are written with all digits, so that they read back as the same
// doubles. Lengths are source units; $INSUNITS says which, where it is known.
#pragma once

#include "pcm/cad/colours.h"
#include "pcm/cloud/geometry.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Whether this library was built with dxflib.
bool writes_dxf();
void require_dxf(const std::filesystem::path& file);  // throws Error(unsupported) where it is false

struct DxfLayer {
    std::string name;  // characters that no layer's name may have (<>/\":;?*|,=` and control characters) become "_"
    int colour = 7;    // AutoCAD's colour index: 1 red, 2 yellow, 3 green, 4 cyan, 5 blue, 6 magenta, 7 black or white
    std::optional<Rgb> true_colour{};  // for programs that have more than the index
};

// Drawing units, with the values of $INSUNITS.
enum class DxfUnit { none = 0, inches = 1, feet = 2, millimetres = 4, centimetres = 5, metres = 6 };

struct DxfSettings {
    DxfUnit unit = DxfUnit::none;
    Box3d extent{};  // box around everything drawn: programs open the drawing with a plan of it. Empty: not known
};

// Streaming, in bounded memory; one thread. The file is in place after finish() only, and replaces an existing one:
// whether it may is for the caller to decide. All functions throw what OutputFile throws; Error(invalid_argument) for
// coordinates that are not finite and for a layer that was not given to the constructor.
class DxfFile {
public:
    // Throws Error(unsupported) where writes_dxf() is false.
    DxfFile(const std::filesystem::path& path, const std::vector<DxfLayer>& layers, const DxfSettings& settings = {});
    ~DxfFile();
    DxfFile(const DxfFile&) = delete;
    DxfFile& operator=(const DxfFile&) = delete;

    void point(const std::string& layer, const Vec3d& p);
    void line(const std::string& layer, const Vec3d& from, const Vec3d& to);
    // A polyline in space; two or more points.
    void polyline(const std::string& layer, const std::vector<Vec3d>& points, bool closed);
    // A flat face with three or four corners; a triangle repeats its last one.
    void face(const std::string& layer, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
    // Across `axis` (unit); radius above 0. The centre is written in the axes that DXF derives from `axis`, which costs
    // its last digits.
    void circle(const std::string& layer, const Vec3d& centre, const Vec3d& axis, double radius);
    // One line of UTF-8, whose lower left corner is at `p`, seen from above; height in source units, above 0.
    void text(const std::string& layer, const Vec3d& p, double height, const std::string& words);

    void finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
