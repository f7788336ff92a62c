#include "pcm/detect/point_labels.h"

#include "pcm/system/error.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace pcm {

File scratch_file(const char* name)
{
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / (name + ("-" + std::to_string(::getpid())));
    File file = File::without_name(path);
    if (file.is_open()) return file;
    file = File(path, File::Mode::create_new);
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return file;
}

PointLabels::PointLabels(const Tree& tree) : file_(scratch_file("pcm-labels")), first_{0}
{
    for (const Node& node : tree.nodes()) first_.push_back(first_.back() + node.points);
    if (::ftruncate(file_.descriptor(), static_cast<off_t>(first_.back() * sizeof(std::uint32_t))) != 0)
        throw Error::from_errno(errno, file_.path(), "making a scratch file");
}

void PointLabels::set(NodeId node, const std::vector<std::uint32_t>& numbers, const std::uint32_t* labels)
{
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
        file_.write_at(labels + i, (end - i) * sizeof(std::uint32_t),
                       (first_[node] + numbers[i]) * sizeof(std::uint32_t));
        i = end;
    }
}

void PointLabels::set_all(NodeId node, const std::vector<std::uint32_t>& labels)
{
    file_.write_at(labels.data(), labels.size() * sizeof(std::uint32_t), first_[node] * sizeof(std::uint32_t));
}

std::vector<std::uint32_t> PointLabels::get(NodeId node) const
{
    std::vector<std::uint32_t> labels(static_cast<std::size_t>(first_[node + 1] - first_[node]));
    file_.read_at(labels.data(), labels.size() * sizeof(std::uint32_t), first_[node] * sizeof(std::uint32_t));
    return labels;
}

}  // namespace pcm
