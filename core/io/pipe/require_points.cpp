#include "pcm/io/pipe/require_points.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"

#include <utility>

namespace pcm {
namespace {

class RequiredPoints final : public PointReader {
public:
    RequiredPoints(std::unique_ptr<PointReader> selected, std::function<Box3d()> cloud)
        : selected_(std::move(selected)), cloud_(std::move(cloud))
    {
    }
    const FileInfo& info() const override { return selected_->info(); }
    double fraction_read() const override { return selected_->fraction_read(); }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        if (selected_->read(batch, max_points)) return any_ = true;
        const Box3d cloud = any_ ? Box3d() : cloud_();
        if (!cloud.empty())
            throw Error(ErrorCode::invalid_argument, {}, "no point is selected, so nothing was written",
                        extent_text(cloud));
        return false;
    }

private:
    std::unique_ptr<PointReader> selected_;
    std::function<Box3d()> cloud_;
    bool any_ = false;
};

}  // namespace

std::unique_ptr<PointReader> require_points(std::unique_ptr<PointReader> selected, std::function<Box3d()> cloud)
{
    return std::make_unique<RequiredPoints>(std::move(selected), std::move(cloud));
}

}  // namespace pcm
