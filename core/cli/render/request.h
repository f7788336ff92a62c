// What a request for pictures means: styles, cameras, names of files.
#pragma once

#include "pcm/gl/draw/renderer.h"
#include "pcm/offscreen/image.h"
#include "pcm/ops/render_request.h"
#include "pcm/view/camera_path.h"

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// Each throws Error(invalid_argument) for what makes no sense, and can be called before a tree is opened.
struct Background {
    bool transparent = false;
    std::array<float, 4> colour{};
};
Background background_of(const ops::RenderRequest& request);
CloudStyle style_of(const ops::RenderRequest& request);
// Whether the trees have the attributes that the style names: the colour's in one of them, the conditions' in all.
// Throws Error(invalid_argument).
void check_attributes(const CloudStyle& style, const std::vector<std::shared_ptr<PointCloud>>& clouds);
// A note where the colour's name is that of an attribute as well; none else.
std::optional<std::string> other_meaning(const CloudStyle& style,
                                         const std::vector<std::shared_ptr<PointCloud>>& clouds);
RenderOptions options_of(const ops::RenderRequest& request);

// The cameras, in source coordinates. Throws what CameraPath::read() throws and Error(invalid_argument).
std::vector<CameraFrame> cameras_of(const ops::RenderRequest& request,
                                    const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box,
                                    ops::PictureSize size);

// One file per picture: OUTPUT itself for a single one; NAME%04d.png with numbers from 1; FOLDER/0001.png, ... Throws
// Error(invalid_argument), and Error(exists) for an existing file without --overwrite.
std::vector<std::filesystem::path> files_of(const ops::RenderRequest& request, std::size_t pictures);

// In the format of its ending; without an alpha channel where the background covers everything. Throws as write_png().
void write_picture(const std::filesystem::path& file, const Image& image, const Background& background);

}  // namespace pcm::cli
