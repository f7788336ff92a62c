// Pictures as other viewers draw them, by their rules for the size of a point: squares (GL_POINTS) with a depth test.
//   bench_peers CLOUD --rule potree --path FILE --out FOLDER         Potree 1.8, adaptive (potree_sizes.h)
//   bench_peers CLOUD --rule constant --point-size PX ...            CloudCompare, and most others: PX pixels
// Writes FOLDER/0001.png ... along the path, transparent where nothing is drawn, and prints a line of JSON: processor
// seconds of each picture, drawn a second time from buffers in video memory.
#include "bench/caches/row.h"
#include "bench/pictures/peers/potree_sizes.h"

#include "pcm/io/reader.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/view/camera_path.h"

#include <GL/glew.h>
#include <CLI/CLI.hpp>

#include <cstddef>
#include <cstdio>
#include <exception>

namespace {

using namespace pcm;
using namespace pcm::bench;

struct Arguments {
    std::string cloud, rule, path, size = "960x720";
    std::filesystem::path out;
    float point_size_px = 2;
};

struct Vertex {
    std::array<float, 3> place;
    std::array<std::uint8_t, 4> colour;
    float size;
};

struct Cloud {
    Vec3d origin{};
    Box3d box;
    std::vector<std::array<float, 3>> places;  // relative to the origin
    std::vector<std::array<std::uint8_t, 4>> colours;
};

Cloud read_cloud(const std::string& file)
{
    const auto reader = open_reader(file);
    const auto rgb = reader->info().schema.find(attribute_name::rgb);
    const auto grid = reader->info().grid;
    if (!rgb || !grid || reader->info().schema[*rgb].type != ScalarType::u16)
        throw std::runtime_error(file + ": a LAS file with colours was expected");
    Cloud cloud;
    cloud.origin = grid->offset;
    PointBatch batch;
    while (reader->read(batch, default_batch_points)) {
        const auto* const colour = batch.attributes[*rgb].as<std::uint16_t>();
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d place{};
            for (std::size_t a = 0; a < 3; ++a) place[a] = grid->to_source(batch.grid_xyz[a][i], a);
            cloud.box.extend(place);
            place = place - cloud.origin;
            cloud.places.push_back(
                {static_cast<float>(place[0]), static_cast<float>(place[1]), static_cast<float>(place[2])});
            cloud.colours.push_back({static_cast<std::uint8_t>(colour[3 * i] >> 8),
                                     static_cast<std::uint8_t>(colour[3 * i + 1] >> 8),
                                     static_cast<std::uint8_t>(colour[3 * i + 2] >> 8), 255});
        }
    }
    return cloud;
}

const char* const vertex_shader = R"(#version 330 compatibility
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 colour;
layout(location = 2) in float size;
uniform mat4 to_clip;
uniform float pixels;  // pixels of a unit at distance 1; 0: sizes are pixels
uniform vec2 limits;
out vec4 shown;
void main()
{
    gl_Position = to_clip * vec4(place, 1.0);
    gl_PointSize = clamp(pixels > 0.0 ? size * pixels / gl_Position.w : size, limits.x, limits.y);
    shown = colour;
}
)";
const char* const fragment_shader = R"(#version 330 compatibility
in vec4 shown;
out vec4 drawn;
void main() { drawn = shown; }
)";

GLuint compiled(GLenum type, const char* text)
{
    const GLuint shader = glCreateShader(type);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint done = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) throw std::runtime_error("a shader of bench_peers does not compile");
    return shader;
}

class Drawing {
public:
    explicit Drawing(const std::vector<Vertex>& vertices) : count_(static_cast<GLsizei>(vertices.size()))
    {
        program_ = glCreateProgram();
        glAttachShader(program_, compiled(GL_VERTEX_SHADER, vertex_shader));
        glAttachShader(program_, compiled(GL_FRAGMENT_SHADER, fragment_shader));
        glLinkProgram(program_);
        GLuint array = 0, buffer = 0;
        glGenVertexArrays(1, &array);
        glBindVertexArray(array);
        glGenBuffers(1, &buffer);
        glBindBuffer(GL_ARRAY_BUFFER, buffer);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                     GL_STATIC_DRAW);
        const auto field = [](GLuint index, GLint components, GLenum type, GLboolean normalised, std::size_t offset) {
            glEnableVertexAttribArray(index);
            glVertexAttribPointer(index, components, type, normalised, sizeof(Vertex),
                                  reinterpret_cast<const void*>(offset));
        };
        field(0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, place));
        field(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, colour));
        field(2, 1, GL_FLOAT, GL_FALSE, offsetof(Vertex, size));
        glUseProgram(program_);
        glEnable(GL_PROGRAM_POINT_SIZE);
        glEnable(GL_DEPTH_TEST);
    }

    void draw(const Camera& view, bool sizes_in_units) const
    {
        const Matrix4d to_clip = product(view.projection, view.modelview);
        std::array<float, 16> matrix{};
        for (std::size_t i = 0; i < 16; ++i) matrix[i] = static_cast<float>(to_clip[i]);
        glUniformMatrix4fv(glGetUniformLocation(program_, "to_clip"), 1, GL_FALSE, matrix.data());
        const double pixels = sizes_in_units ? 0.5 * view.height * view.projection[5] : 0;
        glUniform1f(glGetUniformLocation(program_, "pixels"), static_cast<float>(pixels));
        glUniform2f(glGetUniformLocation(program_, "limits"), sizes_in_units ? potree_least_px : 1.0f, potree_most_px);
        glDrawArrays(GL_POINTS, 0, count_);
        glFinish();
    }

private:
    GLuint program_ = 0;
    GLsizei count_;
};

Row draw(const Arguments& a)
{
    int width = 0, height = 0;
    if (std::sscanf(a.size.c_str(), "%5dx%5d", &width, &height) != 2)
        throw std::runtime_error("--size: WIDTHxHEIGHT in pixels was expected, not " + a.size);
    const Cloud cloud = read_cloud(a.cloud);
    const bool potree = a.rule == "potree";
    const std::vector<float> sizes = potree ? PotreeOctree(cloud.places).sizes() : std::vector<float>();
    std::vector<Vertex> vertices;
    for (std::size_t i = 0; i < cloud.places.size(); ++i)
        vertices.push_back({cloud.places[i], cloud.colours[i], potree ? sizes[i] : a.point_size_px});
    const Offscreen screen(width, height);
    const Drawing drawing(vertices);
    std::filesystem::create_directories(a.out);
    Row row;
    const CameraPath path = CameraPath::read(a.path);
    for (std::size_t i = 0; i < path.frames.size(); ++i) {
        const Camera view = view_of(path.frames[i], cloud.origin, cloud.box, width, height);
        double seconds = 0;
        for (int pass = 0; pass < 2; ++pass) {
            const double start = processor_seconds();
            screen.clear({0, 0, 0, 0});
            drawing.draw(view, potree);
            seconds = processor_seconds() - start;
        }
        row["cpu_seconds"].push_back(seconds);
        row["points_drawn"].push_back(vertices.size());
        char name[32];
        std::snprintf(name, sizeof name, "%04zu.png", i + 1);
        write_png(a.out / name, screen.read());
    }
    row["gl"] = screen.renderer();
    return row;
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Pictures by the rules of other viewers; prints one line of JSON.");
    Arguments a;
    app.add_option("cloud", a.cloud, "LAS file with colours")->required()->check(CLI::ExistingFile);
    app.add_option("--rule", a.rule, "For the size of a point")
        ->required()
        ->check(CLI::IsMember({"potree", "constant"}));
    app.add_option("--point-size", a.point_size_px, "Size of constant points, pixels")->capture_default_str();
    app.add_option("--path", a.path, "Camera path, JSON")->required()->check(CLI::ExistingFile);
    app.add_option("--out", a.out, "Folder for the pictures")->required();
    app.add_option("--size", a.size, "Size of the pictures, pixels")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        std::printf("%s\n", draw(a).dump().c_str());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_peers: %s\n", error.what());
        return 1;
    }
}
