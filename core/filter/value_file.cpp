#include "pcm/filter/value_file.h"

#include "pcm/filter/scratch_file.h"
#include "pcm/system/error.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace pcm {
ValueFile::ValueFile(const Tree& tree, const std::filesystem::path& folder) : file_(scratch_file(folder)), first_{0}
{
    for (const Node& node : tree.nodes()) first_.push_back(first_.back() + node.points);
    if (::ftruncate(file_.descriptor(), static_cast<off_t>(size() * sizeof(double))) != 0)
        throw Error::from_errno(errno, file_.path(), "making a scratch file");
}

void ValueFile::set(NodeId node, const std::vector<std::uint32_t>& indices, const double* values)
{
    for (std::size_t i = 0; i < indices.size();) {
        std::size_t end = i + 1;
        while (end < indices.size() && indices[end] == indices[end - 1] + 1) ++end;
        file_.write_at(values + i, (end - i) * sizeof(double), (first_[node] + indices[i]) * sizeof(double));
        i = end;
    }
}

std::vector<double> ValueFile::get(NodeId node) const
{
    std::vector<double> values(static_cast<std::size_t>(first_[node + 1] - first_[node]));
    file_.read_at(values.data(), values.size() * sizeof(double), first_[node] * sizeof(double));
    return values;
}

void ValueFile::for_each(const std::function<void(const double* values, std::size_t count)>& see) const
{
    std::vector<double> values;
    for (std::uint64_t at = 0; at < size(); at += values.size()) {
        values.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size() - at, 1 << 17)));
        file_.read_at(values.data(), values.size() * sizeof(double), at * sizeof(double));
        see(values.data(), values.size());
    }
}

}  // namespace pcm
