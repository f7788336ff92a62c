#include "pcm/io/xyz/xyz_reader.h"

#include "pcm/io/text/text_reader.h"

namespace pcm {

std::unique_ptr<PointReader> open_xyz(const std::filesystem::path& path, const ReadOptions& options)
{
    return open_text(path, options, {});
}

std::unique_ptr<PointReader> open_pwn(const std::filesystem::path& path, const ReadOptions& options)
{
    TextConventions conventions;
    conventions.columns = {"x y z nx ny nz"};
    conventions.others_refused = "a list of points followed by a list of normals cannot be read";
    return open_text(path, options, conventions);
}

}  // namespace pcm
