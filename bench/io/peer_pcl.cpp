// PCL's readers for bench/io/run.py: "read PATH" and "dump PATH FILE" (positions as doubles). PCD and PLY, into
// PCLPointCloud2: every field as it is in the file, the quicker of PCL's ways.
#include "bench/io/serve.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <array>
#include <cstring>
#include <stdexcept>

namespace {

using pcm::bench::Answer;

bool ends_with(const std::string& text, const std::string& end)
{
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void load(const std::string& path, pcl::PCLPointCloud2& cloud)
{
    int result = -1;
    if (ends_with(path, ".pcd"))
        result = pcl::io::loadPCDFile(path, cloud);
    else if (ends_with(path, ".ply"))
        result = pcl::io::loadPLYFile(path, cloud);
    else
        throw std::runtime_error("PCL reads no such file");
    if (result < 0) throw std::runtime_error("PCL could not read it");
}

Answer work(const std::vector<std::string>& fields)
{
    if (fields.size() < 2) throw std::runtime_error("which file?");
    Answer answer;
    pcl::PCLPointCloud2 cloud;
    const pcm::bench::Stopwatch watch;
    load(fields[1], cloud);
    watch.stop(answer);
    answer.points = std::uint64_t{cloud.width} * cloud.height;
    for (const auto& field : cloud.fields) {
        if (field.name == "_") continue;
        answer.values += field.name == "rgb" ? 3 : field.name == "rgba" ? 4 : field.count;
    }
    if (fields[0] != "dump") return answer;

    pcm::bench::PositionsFile out(fields.at(2));
    std::array<const pcl::PCLPointField*, 3> axes{};
    for (const auto& field : cloud.fields)
        if (field.name.size() == 1 && field.name[0] >= 'x' && field.name[0] <= 'z')
            axes[static_cast<std::size_t>(field.name[0] - 'x')] = &field;
    for (std::uint64_t i = 0; i < answer.points; ++i) {
        std::array<double, 3> p{};
        for (std::size_t a = 0; a < 3; ++a) {
            const auto* at = cloud.data.data() + i * cloud.point_step + axes.at(a)->offset;
            if (axes[a]->datatype == pcl::PCLPointField::FLOAT64) {
                std::memcpy(&p[a], at, sizeof(double));
            } else {
                float value = 0;
                std::memcpy(&value, at, sizeof value);
                p[a] = value;
            }
        }
        out.add(p[0], p[1], p[2]);
    }
    return answer;
}

}  // namespace

int main() { return pcm::bench::serve(work); }
