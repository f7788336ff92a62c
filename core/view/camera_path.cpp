#include "pcm/view/camera_path.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/bounded_json.h"
#include "pcm/system/error.h"
#include "pcm/system/text_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;

// The camera's axes in source axes.
struct Axes {
    Vec3d right, up, back;
};

Axes axes_of(const CameraFrame& frame)
{
    const Vec3d back = normalised(frame.eye - frame.target);
    const Vec3d right = normalised(cross(normalised(frame.up), back));
    return {right, cross(back, right), back};
}

Vec3d corner(const Box3d& box, unsigned number)
{
    Vec3d p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = number >> a & 1u ? box.max[a] : box.min[a];
    return p;
}

[[noreturn]] void refuse_path(const std::string& what) { throw Error(ErrorCode::invalid_argument, {}, what); }

// Errors from here on lack the file and the frame: CameraPath::read() adds them.
Vec3d vector_of(const Json& frame, const char* key)
{
    const auto found = frame.find(key);
    const auto is_number = [](const Json& value) { return value.is_number(); };
    if (found == frame.end() || !found->is_array() || found->size() != 3 ||
        !std::all_of(found->begin(), found->end(), is_number))
        refuse_path(std::string("'") + key + "' is not three numbers");
    return {(*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>()};
}

double number_of(const Json& frame, const char* key)
{
    if (!frame[key].is_number()) refuse_path(std::string("'") + key + "' is not a number");
    return frame[key].get<double>();
}

CameraFrame frame_of(const Json& json)
{
    if (!json.is_object()) refuse_path("it is not an object");
    CameraFrame frame;
    frame.eye = vector_of(json, "eye");
    frame.target = vector_of(json, "target");
    if (json.contains("up")) frame.up = vector_of(json, "up");
    if (json.contains("angle") == json.contains("height")) refuse_path("one of 'angle' and 'height' was expected");
    if (json.contains("angle"))
        frame.angle = number_of(json, "angle");
    else
        frame.height = number_of(json, "height");
    if (json.contains("rest")) {
        if (!json["rest"].is_boolean()) refuse_path("'rest' is neither true nor false");
        frame.rest = json["rest"].get<bool>();
    }
    if (json.contains("name")) {
        if (!json["name"].is_string()) refuse_path("'name' is not a text");
        frame.name = json["name"].get<std::string>();
    }
    check(frame);
    return frame;
}

std::string text_of(const Json& json, const char* key)
{
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

CameraPath path_of(const Json& json, const std::string& name, std::size_t& number)
{
    if (!json.is_object() || text_of(json, "format") != "pcm camera path")
        refuse_path("this is not a camera path: 'format' is not \"pcm camera path\"");
    if (!json.contains("version") || json["version"] != 1)
        refuse_path("'version' is not 1, the only version supported");
    CameraPath path;
    path.name = json.contains("name") ? text_of(json, "name") : name;
    const std::string coordinates = text_of(json, "coordinates");
    if (coordinates != "box" && coordinates != "source") refuse_path("'coordinates' is neither \"box\" nor \"source\"");
    path.in_box = coordinates == "box";
    if (!json.contains("frames") || !json["frames"].is_array() || json["frames"].empty())
        refuse_path("there are no frames");
    for (const Json& frame : json["frames"]) {
        ++number;
        path.frames.push_back(frame_of(frame));
    }
    return path;
}

}  // namespace

void check(const CameraFrame& frame)
{
    if (frame.angle && !(*frame.angle > 0 && *frame.angle < 180))
        refuse_path("'angle' is not between 0 and 180 degrees");
    require_place("the camera's eye", frame.eye);
    require_place("the camera's target", frame.target);
    require_place("the camera's direction 'up'", frame.up);
    if (!frame.angle) {
        require_coordinate("the view's height", frame.height);
        if (!(frame.height > 0)) refuse_path("'height' is not above 0");
    }
    const Vec3d ahead = frame.target - frame.eye;
    if (!(length(ahead) > 0)) refuse_path("'eye' and 'target' are equal");
    if (!(length(frame.up) > 0) || !(length(cross(normalised(ahead), normalised(frame.up))) > 1e-9))
        refuse_path("'up' is parallel to the direction of view");
}

CameraPath CameraPath::read(const std::filesystem::path& file)
{
    constexpr std::uint64_t most_bytes = 64u << 20;  // some 400,000 frames
    return of_text(read_text_file(file, "a camera path", most_bytes), file);
}

CameraPath CameraPath::of_text(const std::string& text, const std::filesystem::path& file)
{
    std::size_t number = 0;
    try {
        return path_of(parse_bounded_json(text), file.stem().string(), number);
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::bad_format, file, std::string("the camera path is not JSON: ") + error.what());
    } catch (const Error& error) {
        throw Error(
            ErrorCode::bad_format, file,
            "camera path" + (number ? ", frame " + std::to_string(number) : std::string()) + ": " + error.what());
    }
}

std::string CameraPath::text() const
{
    nlohmann::ordered_json json;
    json["format"] = "pcm camera path";
    json["version"] = 1;
    json["name"] = name;
    json["coordinates"] = in_box ? "box" : "source";
    json["frames"] = nlohmann::ordered_json::array();
    for (const CameraFrame& frame : frames) {
        nlohmann::ordered_json one;
        if (!frame.name.empty()) one["name"] = frame.name;
        one["eye"] = frame.eye;
        one["target"] = frame.target;
        one["up"] = frame.up;
        if (frame.angle)
            one["angle"] = *frame.angle;
        else
            one["height"] = frame.height;
        if (frame.rest) one["rest"] = true;
        json["frames"].push_back(one);
    }
    return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

CameraPath CameraPath::placed(const Box3d& box) const
{
    if (!in_box) return *this;
    if (box.empty()) refuse_path("a camera path in box coordinates needs a cloud with points");
    const double longest = std::max({box.extent(0), box.extent(1), box.extent(2)});
    const double half = (longest > 0 ? longest : 1e-9) / 2;
    const auto place = [&](Vec3d& v) {
        for (std::size_t a = 0; a < 2; ++a)
            v[a] = (box.min[a] + box.max[a]) / 2 + v[a] * std::max(box.extent(a) / 2, 1e-3 * half);
        v[2] = box.min[2] + v[2] * half;
    };
    CameraPath path = *this;
    path.in_box = false;
    for (CameraFrame& frame : path.frames) {
        place(frame.eye);
        place(frame.target);
        frame.height *= half;
    }
    return path;
}

Camera view_of(const CameraFrame& frame, const Vec3d& origin, const Box3d& box, int width, int height)
{
    const Axes axes = axes_of(frame);
    const Vec3d eye = frame.eye - origin;
    Camera view;
    view.origin = origin;
    view.width = width;
    view.height = height;
    const Vec3d* const rows[3] = {&axes.right, &axes.up, &axes.back};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) view.modelview[c * 4 + r] = (*rows[r])[c];
        view.modelview[12 + r] = -dot(*rows[r], eye);
    }
    view.modelview[15] = 1;

    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (unsigned number = 0; number < 8 && !box.empty(); ++number) {
        const double depth = -dot(axes.back, corner(box, number) - frame.eye);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    if (box.empty()) nearest = farthest = 1;
    // Splats at rest curve away from the eye.
    if (!box.empty())
        farthest += 0.05 * std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
    const double aspect = static_cast<double>(width) / height;
    if (frame.angle) {
        // Noise far behind what is looked at does not push the near plane beyond it.
        const double far = farthest > 0 ? 1.01 * farthest : 1,
                     near = std::max(0.99 * nearest, std::min(far / 20000, 0.1 * length(frame.target - frame.eye)));
        const double f = 1 / std::tan(*frame.angle / 2 * degree);
        view.projection[0] = f / aspect;
        view.projection[5] = f;
        view.projection[10] = (far + near) / (near - far);
        view.projection[11] = -1;
        view.projection[14] = 2 * far * near / (near - far);
    } else {
        const double margin = 0.01 * std::max(farthest - nearest, 0.01 * frame.height), near = nearest - margin,
                     far = farthest + margin;
        view.projection[0] = 2 / (frame.height * aspect);
        view.projection[5] = 2 / frame.height;
        view.projection[10] = 2 / (near - far);
        view.projection[14] = (far + near) / (near - far);
        view.projection[15] = 1;
    }
    return view;
}

CameraFrame overview_of(const Box3d& box, const std::optional<double>& angle, int width, int height)
{
    if (box.empty()) refuse_path("there is nothing to look at: the cloud has no points");
    CameraFrame frame;
    frame.angle = angle;
    frame.target = box.centre();
    // A single point is looked at from a distance that is not lost in the rounding of its coordinates.
    const double apart = std::max(box.diagonal(), 1e-9 * length(frame.target));
    const double size = apart > 0 ? apart : 1e-9;
    const Vec3d back = normalised({-0.5, -1, 0.8});
    frame.eye = frame.target + size * back;
    const Axes axes = axes_of(frame);
    const double margin = 1.05, aspect = static_cast<double>(width) / height;
    const double slope = angle ? std::tan(*angle / 2 * degree) / margin
                               : 1;  // half the picture's height over the distance, without the margin
    // Along the picture's width and height. In perspective a corner p is visible when
    //     |p.axis - shift| <= (away - p.back) * slope:
    // for each sign the largest p.back +- p.axis / slope bounds `away`, which is least when the shift makes both bounds
    // equal. Orthographic: the same without p.back.
    Vec3d shift{0, 0, 0};
    double away = 0.01 * size, half_height = 0.01 * size;
    for (unsigned number = 0; number < 8; ++number)  // with a wide angle the nearest corner could be at the eye
        away = std::max(away, dot(axes.back, corner(box, number) - frame.target) + 0.05 * size);
    for (const bool across : {true, false}) {
        const Vec3d& axis = across ? axes.right : axes.up;
        const double s = across ? slope * aspect : slope;
        double most = -std::numeric_limits<double>::infinity(), least = most;
        for (unsigned number = 0; number < 8; ++number) {
            const Vec3d p = corner(box, number) - frame.target;
            const double depth = angle ? dot(axes.back, p) : 0;
            most = std::max(most, depth + dot(axis, p) / s);
            least = std::max(least, depth - dot(axis, p) / s);
        }
        for (std::size_t a = 0; a < 3; ++a) shift[a] += axis[a] * s * (most - least) / 2;
        away = std::max(away, (most + least) / 2);
        half_height = std::max(half_height, margin * (most + least) / 2);
    }
    frame.height = angle ? 0 : 2 * half_height;
    if (!angle) away = size;
    frame.target = frame.target + shift;
    frame.eye = frame.target + away * back;
    return frame;
}

}  // namespace pcm
