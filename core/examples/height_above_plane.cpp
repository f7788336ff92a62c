// Adds an attribute with every point's signed distance to a plane to a tree, computed by a compute shader, within given
// amounts of main and video memory for a tree of any size. Then reads it back and computes it again on the CPU.
//   height_above_plane city.pct  500000 4800000 90  0 0.1 1  256 64
#include "compute_program.h"

#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/offscreen/offscreen.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace {

// Positions are floats relative to the chunk's origin, so the CPU moves the plane there, in double. `precise` forbids
// fused multiply-adds: the remaining IEEE additions and products, in a given order, give the same bits as the CPU.
const char* const shader = R"(#version 430
layout(local_size_x = 128) in;
layout(std430, binding = 0) readonly buffer Positions { float position[]; };
layout(std430, binding = 1) writeonly buffer Heights { float height[]; };
uniform vec4 plane;
uniform uint count;
void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    precise float h = plane.x * position[3u * i];
    h += plane.y * position[3u * i + 1u];
    h += plane.z * position[3u * i + 2u];
    h += plane.w;
    height[i] = h;
}
)";

struct Plane {
    pcm::Vec3d point, normal;
    double height(const pcm::Vec3d& p) const
    {
        double h = 0;
        for (std::size_t a = 0; a < 3; ++a) h += normal[a] * (p[a] - point[a]);
        return h;
    }
};

// The shader's computation; p is relative to the chunk's origin.
float single_height(const Plane& plane, const pcm::Vec3d& origin, const float p[3])
{
    float h = float(plane.normal[0]) * p[0];
    h += float(plane.normal[1]) * p[1];
    h += float(plane.normal[2]) * p[2];
    h += float(plane.height(origin));
    return h;
}

void bind(GLuint index, const pcm::BufferRange& range)
{
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, index, range.buffer, GLintptr(range.offset), GLsizeiptr(range.bytes));
}

}  // namespace

int main(int argc, char** argv)
try {
    if (argc != 10)
        return std::fprintf(stderr, "usage: height_above_plane TREE  X Y Z  NORMAL_X NORMAL_Y NORMAL_Z  L2_MB L1_MB\n"),
               2;
    Plane plane;
    for (std::size_t a = 0; a < 3; ++a)
        plane.point[a] = std::stod(argv[2 + a]), plane.normal[a] = std::stod(argv[5 + a]);
    const double length = std::sqrt(plane.height(
        {plane.point[0] + plane.normal[0], plane.point[1] + plane.normal[1], plane.point[2] + plane.normal[2]}));
    for (double& n : plane.normal) n /= length;
    pcm::L2Options l2;
    l2.capacity_bytes = std::stoull(argv[8]) << 20;
    pcm::L1Options l1_options;
    l1_options.capacity_bytes = std::stoull(argv[9]) << 20;

    const pcm::Offscreen context;
    pcm::require_compute_shaders();
    const GLuint program = compute_program(shader);
    const GLint plane_of = glGetUniformLocation(program, "plane"), count_of = glGetUniformLocation(program, "count");

    const auto l1 = std::make_shared<pcm::L1Cache>(l1_options);
    auto cloud = pcm::PointCloud::open(argv[1], l2, pcm::Access::write);
    if (!cloud->info().schema.find("height")) cloud->add_attribute({"height", pcm::ScalarType::f32});
    pcm::Query query;
    query.attributes = {"height"};
    {
        pcm::GpuCursor cursor(cloud, l1, query);
        glUseProgram(program);
        for (pcm::GpuView view; cursor.getNextDataGPU(view); view.mark_written(0)) {
            const double w = plane.height(view.grid().to_source(view.origin()));
            glUniform4f(plane_of, float(plane.normal[0]), float(plane.normal[1]), float(plane.normal[2]), float(w));
            for (const pcm::GpuPiece& piece : view.pieces()) {
                bind(0, piece.positions);
                bind(1, piece.attributes[0]);
                glUniform1ui(count_of, piece.count);
                glDispatchCompute((piece.count + 127) / 128, 1, 1);
            }
        }
    }
    cloud->close();  // commits the changes atomically
    const pcm::L1Statistics statistics = l1->statistics();

    cloud = pcm::PointCloud::open(argv[1], l2);
    const pcm::Grid grid = cloud->info().grid;
    auto cursor = cloud->points(query);
    std::size_t points = 0, wrong = 0;
    double error = 0;
    for (pcm::PointView view; cursor.getNextData(view); points += view.size()) {
        const auto chunk = cloud->cache().get(view.node(), pcm::ColumnSet::only_positions());
        const pcm::Vec3d origin = grid.to_source(chunk->positions->origin);
        for (std::size_t i = 0; i < view.size(); ++i) {
            float relative[3];
            for (std::size_t a = 0; a < 3; ++a)
                relative[a] = float(double(chunk->positions->relative(view.index(i), a)) * grid.scale[a]);
            const double height = view.value(i, 0);
            wrong += height != double(single_height(plane, origin, relative));
            error = std::max(error, std::abs(height - plane.height(view.position(i))));
        }
    }
    std::printf("%zu points, %zu of them have another height; at most %.2g from the result in double precision\n",
                points, wrong, error);
    std::printf("%.0f MB uploaded to video memory, %.0f MB read back\n", double(statistics.uploaded_bytes) / 1e6,
                double(statistics.written_back_bytes) / 1e6);
    l1->release();
    return wrong ? 1 : 0;
} catch (const std::exception& error) {
    return std::fprintf(stderr, "height_above_plane: %s\n", error.what()), 1;
}
