#include "camera_path.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace pcm::bench {
namespace {

using Json = nlohmann::json;

Vec3d vector_of(const Json& frame, const char* key)
{
    const Json& value = frame.at(key);
    if (!value.is_array() || value.size() != 3) throw std::runtime_error(std::string("'") + key + "' is not three numbers");
    Vec3d v{};
    for (std::size_t a = 0; a < 3; ++a) v[a] = value[a].get<double>();
    return v;
}

Vec3d cross(const Vec3d& a, const Vec3d& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length(const Vec3d& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

CameraFrame frame_of(const Json& json)
{
    CameraFrame frame;
    frame.eye = vector_of(json, "eye");
    frame.target = vector_of(json, "target");
    if (json.contains("up")) frame.up = vector_of(json, "up");
    if (json.contains("angle") == json.contains("height")) throw std::runtime_error("one of 'angle' and 'height' was expected");
    if (json.contains("angle")) {
        frame.angle = json["angle"].get<double>();
        if (!(*frame.angle > 0 && *frame.angle < 180)) throw std::runtime_error("'angle' is not between 0 and 180 degrees");
    } else {
        frame.height = json["height"].get<double>();
        if (!(frame.height > 0)) throw std::runtime_error("'height' is not above 0");
    }
    frame.rest = json.value("rest", false);
    const Vec3d ahead{frame.target[0] - frame.eye[0], frame.target[1] - frame.eye[1], frame.target[2] - frame.eye[2]};
    if (!(length(cross(ahead, frame.up)) > 1e-9 * length(ahead) * length(frame.up)))
        throw std::runtime_error("'up' is along the view, or 'eye' is the 'target'");
    return frame;
}

}  // namespace

CameraPath CameraPath::read(const std::filesystem::path& file)
{
    std::ifstream stream(file);
    if (!stream) throw std::runtime_error("cannot read the camera path " + file.string());
    std::size_t number = 0;
    try {
        const Json json = Json::parse(stream);
        if (json.at("format") != "pcm camera path" || json.at("version") != 1)
            throw std::runtime_error("not a camera path of version 1");
        CameraPath path;
        path.name = json.value("name", file.stem().string());
        const std::string coordinates = json.at("coordinates");
        if (coordinates != "box" && coordinates != "source") throw std::runtime_error("'coordinates' is neither \"box\" nor \"source\"");
        path.in_box = coordinates == "box";
        for (const Json& frame : json.at("frames")) {
            ++number;
            path.frames.push_back(frame_of(frame));
        }
        if (path.frames.empty()) throw std::runtime_error("no frames");
        return path;
    } catch (const std::exception& error) {
        throw std::runtime_error("camera path " + file.string() + (number ? ", frame " + std::to_string(number) : "") + ": " + error.what());
    }
}

CameraPath CameraPath::placed(const Box3d& box) const
{
    if (!in_box) return *this;
    const double half = std::max({box.extent(0), box.extent(1), box.extent(2), 1e-9}) / 2;
    const auto place = [&](Vec3d& v) {
        for (std::size_t a = 0; a < 2; ++a) v[a] = (box.min[a] + box.max[a]) / 2 + v[a] * std::max(box.extent(a) / 2, 1e-3 * half);
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

}  // namespace pcm::bench
