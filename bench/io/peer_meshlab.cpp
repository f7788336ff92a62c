// MeshLab's own readers for bench/io/run.py: "read PATH" and "dump PATH FILE" (positions as doubles). The importers
// that its plugins call (vcglib's PLY and PTX, its own XYZ, which takes PTS too), into vertices like MeshLab's: float
// positions.
#include "bench/io/serve.h"

#include <vcg/complex/complex.h>
#include <wrap/io_trimesh/import_ply.h>
#include <wrap/io_trimesh/import_ptx.h>

#include <import_xyz.h>

#include <stdexcept>

namespace {

using pcm::bench::Answer;

class Vertex;
class Face;
struct Types : vcg::UsedTypes<vcg::Use<Vertex>::AsVertexType, vcg::Use<Face>::AsFaceType> {};
class Vertex
    : public vcg::Vertex<Types, vcg::vertex::InfoOcf, vcg::vertex::Coord3f, vcg::vertex::BitFlags,
                         vcg::vertex::Normal3f, vcg::vertex::Qualityf, vcg::vertex::Color4b, vcg::vertex::RadiusfOcf> {
};
class Face
    : public vcg::Face<Types, vcg::face::VertexRef, vcg::face::BitFlags, vcg::face::Normal3f, vcg::face::Color4b> {};
class Mesh : public vcg::tri::TriMesh<vcg::vertex::vector_ocf<Vertex>, std::vector<Face>> {};

bool ends_with(const std::string& text, const std::string& end)
{
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Scalars kept of a vertex.
std::uint64_t load(const std::string& path, Mesh& mesh)
{
    using vcg::tri::io::Mask;
    int mask = 0, result = 0;
    if (ends_with(path, ".ply")) {
        result = vcg::tri::io::ImporterPLY<Mesh>::Open(mesh, path.c_str(), mask);
    } else if (ends_with(path, ".ptx")) {
        vcg::tri::io::ImporterPTX<Mesh>::Info info;
        info.pointsonly = true;
        info.switchside = false;
        result = vcg::tri::io::ImporterPTX<Mesh>::Open(mesh, path.c_str(), info);
        mask = info.mask;
    } else if (ends_with(path, ".xyz") || ends_with(path, ".pts")) {
        result = vcg::tri::io::ImporterXYZ<Mesh>::Open(mesh, path.c_str(), mask);
    } else {
        throw std::runtime_error("MeshLab reads no such file");
    }
    if (result != 0) throw std::runtime_error("MeshLab's importer ended with " + std::to_string(result));
    return 3u + (mask & Mask::IOM_VERTNORMAL ? 3u : 0u) + (mask & Mask::IOM_VERTCOLOR ? 3u : 0u) +
           (mask & Mask::IOM_VERTQUALITY ? 1u : 0u);
}

Answer work(const std::vector<std::string>& fields)
{
    if (fields.size() < 2) throw std::runtime_error("which file?");
    Answer answer;
    Mesh mesh;
    const pcm::bench::Stopwatch watch;
    answer.values = load(fields[1], mesh);
    watch.stop(answer);
    answer.points = static_cast<std::uint64_t>(mesh.vn);
    if (answer.points == 0) throw std::runtime_error("no points came");
    if (fields[0] == "dump") {
        pcm::bench::PositionsFile out(fields.at(2));
        for (const Vertex& vertex : mesh.vert) out.add(vertex.cP()[0], vertex.cP()[1], vertex.cP()[2]);
    }
    return answer;
}

}  // namespace

int main() { return pcm::bench::serve(work); }
