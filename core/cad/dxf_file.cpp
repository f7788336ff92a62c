#include "pcm/cad/dxf_file.h"

#include "pcm/cad/dxf_text.h"
#include "pcm/cloud/exact_products.h"
#include "pcm/system/error.h"

#ifdef PCM_HAVE_DXFLIB

#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <dxflib/dl_dxf.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string_view>

namespace pcm {
namespace {

// dxflib's writer, with the bytes going where errors are noticed, and numbers with all digits. Its own stream is not
// used.
class Writer : public DL_WriterA {
public:
    explicit Writer(const std::filesystem::path& path) : DL_WriterA("/dev/null", DL_VERSION_2000), file_(path) {}

    void dxfReal(int code, double value) const override
    {
        const auto other = instead.find(code);
        put(code, exact(other == instead.end() ? value : other->second));
    }
    void dxfInt(int code, int value) const override { put(code, std::to_string(value)); }
    void dxfHex(int code, int value) const override
    {
        if (seed_follows_) {
            put(code, hex(0, 8));
            seed_at_ = file_.size() - 9;  // its digits and the end of the line
            seed_follows_ = false;
        } else {
            put(code, hex(static_cast<unsigned long>(value), 1));
        }
        if (owners_) put_owner(code, value);
    }
    void dxfString(int code, const char* value) const override
    {
        put(code, value);
        seed_follows_ = value == std::string_view("$HANDSEED");
    }
    void dxfString(int code, const std::string& value) const override { dxfString(code, value.c_str()); }

    // The handle from which programs number what they add is above all of this file: dxflib's is 65535, whatever
    // follows.
    void put_seed() { file_.rewrite(hex(getNextHandle(), 8).data(), 8, seed_at_); }

    // From here on each object names its owner, the dictionary that has its handle (code 350); the first one has none.
    // dxflib leaves that out.
    void begin_owners() { owners_.emplace(); }

    OutputFile& file() { return file_; }

    std::map<int, double> instead;  // numbers that are written whatever the library writes

private:
    static std::string hex(unsigned long value, int digits)
    {
        char text[24];
        std::snprintf(text, sizeof text, "%0*lX", digits, value);
        return text;
    }
    void put(int code, const std::string& value) const
    {
        const std::string number = std::to_string(code);
        file_.append(std::string(number.size() < 3 ? 3 - number.size() : 0, ' ') + number + "\n" + value + "\n");
    }
    void put_owner(int code, int handle) const
    {
        if (code == 350) owners_->emplace(handle, object_);
        if (code != 5) return;
        const auto owner = owners_->find(handle);
        put(330, hex(owner == owners_->end() ? 0 : static_cast<unsigned long>(owner->second), 1));
        object_ = handle;
    }
    mutable OutputFile file_;
    mutable std::optional<std::map<int, int>> owners_;  // handles, keyed by what they own
    mutable int object_ = 0;                            // handle of the one being written
    mutable bool seed_follows_ = false;
    mutable std::uint64_t seed_at_ = 0;
};

void check_finite(const Vec3d& p)
{
    if (!is_finite(p)) throw Error(ErrorCode::invalid_argument, {}, "a coordinate for the DXF file is not finite");
}

// The axes that DXF derives from an entity's normal ("arbitrary axis algorithm").
struct ObjectAxes {
    explicit ObjectAxes(const Vec3d& normal) : z(normal)
    {
        constexpr double limit = 1.0 / 64;
        const bool is_upright = std::fabs(z[0]) < limit && std::fabs(z[1]) < limit;
        x = normalised(cross(is_upright ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}, z));
        y = cross(z, x);
    }
    Vec3d x{}, y{}, z;
};

// Numbers of the view's record for a plan of the extent: its centre, its height, width by height.
std::map<int, double> view_of(const Box3d& extent)
{
    if (extent.empty()) return {};
    constexpr double width_by_height = 1.5;
    const double height = 1.1 * std::max(extent.extent(1), extent.extent(0) / width_by_height);
    const Vec3d centre = extent.centre();
    return {{12, centre[0]}, {22, centre[1]}, {40, height > 0 ? height : 1}, {41, width_by_height}};
}

}  // namespace

bool writes_dxf() { return true; }
void require_dxf(const std::filesystem::path&) {}

struct DxfFile::State {
    explicit State(const std::filesystem::path& path) : writer(path) {}

    // The beginning of an entity of a layer.
    void begin(const char* entity, const std::string& layer)
    {
        const std::string name = dxf_layer_name(layer);
        if (std::find(layers.begin(), layers.end(), name) == layers.end())
            throw Error(ErrorCode::invalid_argument, writer.file().path(), "the DXF file has no layer '" + layer + "'");
        writer.entity(entity);
        put_layer(name);
    }
    void put_layer(const std::string& name)
    {
        writer.dxfString(100, "AcDbEntity");
        writer.dxfString(8, name);
    }
    void put_tables(const std::vector<DxfLayer>& given, const DxfSettings& settings);
    void put_settings(const DxfSettings& settings);
    void put_layers(const std::vector<DxfLayer>& given);
    void put_blocks();

    DL_Dxf library;
    Writer writer;
    std::vector<std::string> layers;
};

void DxfFile::State::put_layers(const std::vector<DxfLayer>& given)
{
    std::vector<DxfLayer> table{{"0", 7, {}}};
    for (const DxfLayer& layer : given) {
        const std::string name = dxf_layer_name(layer.name);
        if (std::none_of(table.begin(), table.end(), [&](const DxfLayer& other) { return other.name == name; }))
            table.push_back({name, layer.colour, layer.true_colour});
    }
    writer.tableLayers(static_cast<int>(table.size()));
    for (const DxfLayer& layer : table) {
        int colour = -1;
        if (const auto& c = layer.true_colour) colour = (*c)[0] << 16 | (*c)[1] << 8 | (*c)[2];
        library.writeLayer(writer, DL_LayerData(layer.name, 0),
                           DL_Attributes("", layer.colour, colour, -1, "CONTINUOUS", 1.0));
        layers.push_back(layer.name);
    }
    writer.tableEnd();
}

void DxfFile::State::put_tables(const std::vector<DxfLayer>& given, const DxfSettings& settings)
{
    writer.sectionTables();
    writer.instead = view_of(settings.extent);
    library.writeVPort(writer);
    writer.instead.clear();
    writer.tableLinetypes(3);
    for (const char* type : {"BYBLOCK", "BYLAYER", "CONTINUOUS"})
        library.writeLinetype(writer, DL_LinetypeData(type, "", 0, 0, 0.0));
    writer.tableEnd();
    put_layers(given);
    writer.tableStyle(1);
    library.writeStyle(writer, DL_StyleData("Standard", 0, 0.0, 1.0, 0.0, 0, 2.5, "txt", ""));
    writer.tableEnd();
    library.writeView(writer);
    library.writeUcs(writer);
    writer.tableAppid(1);
    library.writeAppid(writer, "ACAD");
    writer.tableEnd();
    library.writeDimStyle(writer, 2.5, 1.25, 0.625, 0.625, 2.5);
    library.writeBlockRecord(writer);
    writer.tableEnd();
    writer.sectionEnd();
}

void DxfFile::State::put_settings(const DxfSettings& settings)
{
    writer.dxfString(9, "$INSUNITS");
    writer.dxfInt(70, static_cast<int>(settings.unit));
    if (settings.unit != DxfUnit::none) {
        const bool imperial = settings.unit == DxfUnit::feet || settings.unit == DxfUnit::inches;
        writer.dxfString(9, "$MEASUREMENT");
        writer.dxfInt(70, imperial ? 0 : 1);
    }
    const Box3d& extent = settings.extent;
    if (extent.empty()) return;
    check_finite(extent.min);
    check_finite(extent.max);
    writer.dxfString(9, "$EXTMIN");
    writer.coord(10, extent.min[0], extent.min[1], extent.min[2]);
    writer.dxfString(9, "$EXTMAX");
    writer.coord(10, extent.max[0], extent.max[1], extent.max[2]);
}

void DxfFile::State::put_blocks()
{
    writer.sectionBlocks();
    for (const char* name : {"*Model_Space", "*Paper_Space", "*Paper_Space0"}) {
        library.writeBlock(writer, DL_BlockData(name, 0, 0.0, 0.0, 0.0));
        library.writeEndBlock(writer, name);
    }
    writer.sectionEnd();
}

DxfFile::DxfFile(const std::filesystem::path& path, const std::vector<DxfLayer>& layers, const DxfSettings& settings)
    : state_(std::make_unique<State>(path))
{
    State& state = *state_;
    state.library.writeHeader(state.writer);
    state.put_settings(settings);
    state.writer.sectionEnd();
    state.put_tables(layers, settings);
    state.put_blocks();
    state.writer.sectionEntities();
}

DxfFile::~DxfFile() = default;

void DxfFile::point(const std::string& layer, const Vec3d& p)
{
    check_finite(p);
    state_->begin("POINT", layer);
    state_->writer.dxfString(100, "AcDbPoint");
    state_->writer.coord(10, p[0], p[1], p[2]);
}

void DxfFile::line(const std::string& layer, const Vec3d& from, const Vec3d& to)
{
    check_finite(from);
    check_finite(to);
    state_->begin("LINE", layer);
    state_->writer.dxfString(100, "AcDbLine");
    state_->writer.coord(10, from[0], from[1], from[2]);
    state_->writer.coord(11, to[0], to[1], to[2]);
}

void DxfFile::polyline(const std::string& layer, const std::vector<Vec3d>& points, bool closed)
{
    // dxflib writes polylines of this version without z.
    constexpr int in_space = 8, vertex_in_space = 32;
    if (points.size() < 2)
        throw Error(ErrorCode::invalid_argument, state_->writer.file().path(), "a polyline has two or more points");
    for (const Vec3d& p : points) check_finite(p);
    Writer& writer = state_->writer;
    state_->begin("POLYLINE", layer);
    writer.dxfString(100, "AcDb3dPolyline");
    writer.dxfInt(66, 1);
    writer.coord(10, 0, 0, 0);
    writer.dxfInt(70, in_space + (closed ? 1 : 0));
    const std::string name = dxf_layer_name(layer);
    for (const Vec3d& p : points) {
        writer.entity("VERTEX");
        state_->put_layer(name);
        writer.dxfString(100, "AcDbVertex");
        writer.dxfString(100, "AcDb3dPolylineVertex");
        writer.coord(10, p[0], p[1], p[2]);
        writer.dxfInt(70, vertex_in_space);
    }
    writer.entity("SEQEND");
    state_->put_layer(name);
}

void DxfFile::face(const std::string& layer, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d)
{
    for (const Vec3d& p : {a, b, c, d}) check_finite(p);
    state_->begin("3DFACE", layer);
    state_->writer.dxfString(100, "AcDbFace");
    int code = 10;
    for (const Vec3d& p : {a, b, c, d}) state_->writer.coord(code++, p[0], p[1], p[2]);
}

void DxfFile::circle(const std::string& layer, const Vec3d& centre, const Vec3d& axis, double radius)
{
    const ObjectAxes axes(axis);
    check_finite(centre);
    check_finite(axes.x);
    Writer& writer = state_->writer;
    if (!(radius > 0 && std::isfinite(radius)))
        throw Error(ErrorCode::invalid_argument, writer.file().path(), "the radius of a circle is not above 0");
    state_->begin("CIRCLE", layer);
    writer.dxfString(100, "AcDbCircle");
    writer.coord(10, exact_dot(centre, axes.x), exact_dot(centre, axes.y), exact_dot(centre, axes.z));
    writer.dxfReal(40, radius);
    writer.coord(210, axes.z[0], axes.z[1], axes.z[2]);
}

void DxfFile::text(const std::string& layer, const Vec3d& p, double height, const std::string& words)
{
    check_finite(p);
    if (!(height > 0 && std::isfinite(height)))
        throw Error(ErrorCode::invalid_argument, state_->writer.file().path(), "the height of a text is not above 0");
    state_->begin("TEXT", layer);
    state_->writer.dxfString(100, "AcDbText");
    state_->writer.coord(10, p[0], p[1], p[2]);
    state_->writer.dxfReal(40, height);
    state_->writer.dxfString(1, dxf_text(words));
    state_->writer.dxfString(100, "AcDbText");
}

void DxfFile::finish()
{
    state_->writer.sectionEnd();
    state_->writer.begin_owners();
    state_->library.writeObjects(state_->writer);
    state_->library.writeObjectsEnd(state_->writer);
    state_->writer.dxfEOF();
    state_->writer.put_seed();
    state_->writer.file().finish();
}

}  // namespace pcm

#else

namespace pcm {

bool writes_dxf() { return false; }
void require_dxf(const std::filesystem::path& file)
{
    throw Error(ErrorCode::unsupported, file, "DXF cannot be written: the library was built without dxflib",
                "install libdxflib-dev and build it again, or choose another format");
}

struct DxfFile::State {};

DxfFile::DxfFile(const std::filesystem::path& path, const std::vector<DxfLayer>&, const DxfSettings&)
{
    require_dxf(path);
}
DxfFile::~DxfFile() = default;
void DxfFile::point(const std::string&, const Vec3d&) {}
void DxfFile::line(const std::string&, const Vec3d&, const Vec3d&) {}
void DxfFile::polyline(const std::string&, const std::vector<Vec3d>&, bool) {}
void DxfFile::face(const std::string&, const Vec3d&, const Vec3d&, const Vec3d&, const Vec3d&) {}
void DxfFile::circle(const std::string&, const Vec3d&, const Vec3d&, double) {}
void DxfFile::text(const std::string&, const Vec3d&, double, const std::string&) {}
void DxfFile::finish() {}

}  // namespace pcm

#endif
