#include "pcm/remote/open_bytes.h"

#include "pcm/remote/remote_file.h"
#include "pcm/system/file.h"
#include "pcm/system/url.h"

namespace pcm {

std::shared_ptr<const ByteSource> open_bytes(const std::filesystem::path& path)
{
    if (is_url(path)) return std::make_shared<const RemoteFile>(path);
    return std::make_shared<const File>(path, File::Mode::read);
}

}  // namespace pcm
