// Primitives as STEP: solids and trimmed planes, by the shared object of cad/step.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/iso_text.h"
#include "pcm/cad/step/step_module.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/shape_solids.h"
#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "pcm/system/shared_module.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

namespace pcm {
namespace {

constexpr const char* module_file = "libpcm_step.so";

const SharedModule& module()
{
    static const SharedModule loaded = load_shared_module(module_file, step_module_symbol, step_module_version);
    return loaded;
}

const StepFunctions& functions_for(const std::filesystem::path& file)
{
    const SharedModule& step = module();
    if (!step.functions)
        throw Error(ErrorCode::unsupported, file, "STEP files cannot be written here: " + step.missing,
                    "install libpcm_step.so (built where libocct-data-exchange-dev is installed), or write a .dxf");
    return *static_cast<const StepFunctions*>(step.functions);
}

void set(double (&to)[3], const Vec3d& from) { std::copy(from.begin(), from.end(), to); }

// All shapes, as the shared object takes them.
class StepShapes : public ShapeSolids {
public:
    void begin(const Primitive& primitive)
    {
        StepShape shape{};
        shape.name = primitive.name.c_str();
        for (std::size_t c = 0; c < 3; ++c) shape.colour[c] = primitive.colour[c] / 255.0;
        set_axis(shape, {0, 0, 1});
        all_.push_back(shape);
    }

    void face(const Vec3d& point, const Vec3d& normal, const std::vector<Vec3d>& corners) override
    {
        StepShape& shape = all_.back();
        shape.form = StepShape::Form::face;
        set(shape.place, point);
        set_axis(shape, normal);
        static_assert(sizeof(Vec3d) == sizeof(double[3]));
        shape.corners = reinterpret_cast<const double(*)[3]>(corners.data());
        shape.corner_count = corners.size();
    }

    void frustum(const Vec3d& base, const Vec3d& axis, double radius, double other_radius, double length) override
    {
        StepShape& shape = all_.back();
        shape.form = StepShape::Form::frustum;
        set(shape.place, base);
        set_axis(shape, axis);
        shape.radius = radius;
        shape.second = other_radius;
        shape.length = length;
    }

    void ball(const Vec3d& centre, double radius) override
    {
        StepShape& shape = all_.back();
        shape.form = StepShape::Form::ball;
        set(shape.place, centre);
        shape.radius = radius;
    }

    void ring(const Vec3d& centre, const Vec3d& axis, const Vec3d& zero, double radius, double tube_radius,
              double arc) override
    {
        StepShape& shape = all_.back();
        shape.form = StepShape::Form::ring;
        set(shape.place, centre);
        set(shape.axis, axis);
        set(shape.zero, zero);
        shape.radius = radius;
        shape.second = tube_radius;
        shape.arc = arc;
    }

    const std::vector<StepShape>& all() const { return all_; }

private:
    static void set_axis(StepShape& shape, const Vec3d& axis)
    {
        set(shape.axis, axis);
        set(shape.zero, AxisFrame(axis).u);
    }

    std::vector<StepShape> all_;
};

// STEP files have a unit, always.
StepUnit step_unit(CadUnit unit)
{
    switch (unit) {
        case CadUnit::millimetres:
            return {"MM", 1};
        case CadUnit::centimetres:
            return {"CM", 10};
        case CadUnit::feet:
            return {"FT", 304.8};
        case CadUnit::inches:
            return {"INCH", 25.4};
        case CadUnit::none:
        case CadUnit::metres:
            break;
    }
    return {"M", 1000};
}

// Keeps what an OutputFile throws while OpenCASCADE writes, which does not expect it.
struct Sink {
    OutputFile& output;
    std::exception_ptr failure;
    std::string begun;  // the first bytes of a character whose others follow

    static bool append(void* to, const char* bytes, std::size_t size)
    {
        Sink& sink = *static_cast<Sink*>(to);
        if (sink.failure) return false;
        try {
            sink.begun.append(bytes, size);
            sink.output.append(iso_characters(sink.begun));
        } catch (...) {
            sink.failure = std::current_exception();
        }
        return !sink.failure;
    }
};

}  // namespace

bool writes_step() { return has_shared_module(module_file); }

void require_step(const std::filesystem::path& file) { functions_for(file); }

void write_step(const std::filesystem::path& file, DrawingList& list, const CadOptions& options)
{
    const StepFunctions& functions = functions_for(file);
    StepShapes shapes;
    for (const Primitive* primitive : list.shown) {
        shapes.begin(*primitive);
        traits_of(primitive->fit.shape.kind).solid(primitive->fit.shape, primitive->bounds, shapes);
    }
    list.note_unit(options.unit, "a STEP file");
    const StepUnit unit = step_unit(options.unit);
    OutputFile output(file);
    Sink sink{output, {}, {}};
    std::size_t shape = shapes.all().size();
    char message[step_message_bytes] = "out of memory";
    static std::mutex one_at_a_time;  // OpenCASCADE's settings are global
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    const bool written = functions.write(shapes.all().data(), shapes.all().size(), file.filename().c_str(), &unit,
                                         Sink::append, &sink, &shape, message);
    if (sink.failure) std::rethrow_exception(sink.failure);
    if (!written)
        throw Error(ErrorCode::invalid_argument, file,
                    (shape < list.shown.size() ? "'" + list.shown[shape]->name + "' cannot be written: "
                                               : std::string("OpenCASCADE: ")) +
                        message,
                    "hide it, or write a .dxf");
    output.finish();
}

}  // namespace pcm
