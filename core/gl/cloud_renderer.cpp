#include "gl/cloud_renderer.h"

#include "gl/chunk_feed.h"
#include "gl/frame_budget.h"
#include "gl/gl_state.h"
#include "gl/shader_program.h"
#include "view/level_of_detail.h"
#include "view/motion.h"

#include <GL/glew.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Program {
    ShaderProgram program;
    GLint reference = -1, to_eye = -1, translation = -1, projection = -1, point_size = -1, height = -1,
          uniform_colour = -1;

    void build(const std::vector<std::string>& defines)
    {
        program = ShaderProgram("splat.vert", "splat.frag", defines);
        reference = program.uniform("reference");
        to_eye = program.uniform("to_eye");
        translation = program.uniform("translation");
        projection = program.uniform("projection");
        point_size = program.uniform("point_size");
        height = program.uniform("height");
        uniform_colour = program.uniform("uniform_colour");
    }
};

}  // namespace

struct CloudRenderer::Impl {
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<L1Cache> l1;
    bool l1_is_own = false;
    std::unique_ptr<ChunkFeed> feed;
    Program vertex_colour_program, height_program, uniform_program;
    unsigned frames_since_build = 0;
    float point_size_most = 1;

    FrameBudget budget;
    std::optional<View> last_view;
    std::deque<std::pair<Camera, Vec3d>> recent_cameras;  // several views may draw in turn

    // --- choice -----------------------------------------------------------------------------------------------------

    ColourMode usable_mode(ColourMode asked) const
    {
        const Schema& schema = cloud->info().schema;
        if (asked == ColourMode::rgb) {
            const auto i = schema.find(attribute_name::rgb);
            if (i && schema[*i].components >= 3) return asked;
            asked = ColourMode::intensity;
        }
        if (asked == ColourMode::intensity && !schema.find(attribute_name::intensity)) asked = ColourMode::height;
        return asked;
    }

    static VertexFormat vertex_format(ColourMode mode)
    {
        CloudStyle style;
        style.colour = mode;
        return format_of(style);
    }

    bool rests(const Camera& camera, const Vec3d& local_origin)
    {
        const auto same = [&](const std::pair<Camera, Vec3d>& other) {
            return std::memcmp(&other.first, &camera, sizeof(Camera)) == 0 && other.second == local_origin;
        };
        if (std::any_of(recent_cameras.begin(), recent_cameras.end(), same)) return true;
        recent_cameras.emplace_front(camera, local_origin);
        if (recent_cameras.size() > 4) recent_cameras.pop_back();
        return false;
    }

    // --- drawing
    // ------------------------------------------------------------------------------------------------------

    void build_programs(bool compatibility)
    {
        if (uniform_program.program) return;
        vertex_colour_program.build({"VERTEX_COLOUR"});
        height_program.build({"HEIGHT_COLOUR"});
        uniform_program.build({});
        float range[2] = {1, 1};
        glGetFloatv(compatibility ? GL_ALIASED_POINT_SIZE_RANGE : GL_POINT_SIZE_RANGE, range);
        point_size_most = std::max(1.0f, range[1]);
        frames_since_build = 0;
    }

    void release_programs()
    {
        vertex_colour_program.program.release();
        height_program.program.release();
        uniform_program.program.release();
    }

    void set_common(const Program& program, const Camera& camera, const RenderOptions& options) const
    {
        glUseProgram(program.program.id());
        float projection[16];
        for (std::size_t i = 0; i < 16; ++i) projection[i] = static_cast<float>(camera.projection[i]);
        glUniformMatrix4fv(program.projection, 1, GL_FALSE, projection);
        float to_eye[9];
        for (std::size_t column = 0; column < 3; ++column)
            for (std::size_t row = 0; row < 3; ++row)
                to_eye[column * 3 + row] =
                    static_cast<float>(camera.modelview[column * 4 + row] / camera.modelview[15]);
        glUniformMatrix3fv(program.to_eye, 1, GL_FALSE, to_eye);
        glUniform1f(program.point_size, std::clamp(options.point_size_px, 1.0f, point_size_most));
        glUniform3fv(program.uniform_colour, 1, options.uniform_colour.data());
    }

    // See shaders/splat.vert: the reference is the point of the chunk's box nearest to the eye.
    void set_chunk(const Program& program, const VertexEntry& entry, const Camera& camera, const Vec3d& local_origin,
                   const Vec3d& local_eye) const
    {
        const TreeInfo& info = cloud->info();
        double local_reference[3];
        float reference[3];
        for (std::size_t a = 0; a < 3; ++a) {
            // Where the grid's offset is the local origin, the large numbers cancel exactly.
            const double chunk_origin =
                static_cast<double>(entry.origin[a]) * info.grid.scale[a] + (info.grid.offset[a] - local_origin[a]);
            reference[a] = static_cast<float>(std::clamp(local_eye[a] - chunk_origin, 0.0, entry.extent[a]));
            local_reference[a] = chunk_origin + static_cast<double>(reference[a]);
        }
        float translation[3];
        for (std::size_t row = 0; row < 3; ++row) {
            double sum = camera.modelview[12 + row];
            for (std::size_t column = 0; column < 3; ++column)
                sum += camera.modelview[column * 4 + row] * local_reference[column];
            translation[row] = static_cast<float>(sum / camera.modelview[15]);
        }
        glUniform3fv(program.reference, 1, reference);
        glUniform3fv(program.translation, 1, translation);
        if (program.height >= 0) {
            const double bottom = static_cast<double>(info.box.min[2]);
            const double top = static_cast<double>(info.box.max[2]);
            const double range = (top - bottom) * info.grid.scale[2];
            const double above = (static_cast<double>(entry.origin[2]) - bottom) * info.grid.scale[2];
            const bool flat = !(range > 0);
            glUniform2f(program.height, flat ? 0.0f : static_cast<float>(1 / range),
                        flat ? 0.5f : static_cast<float>(above / range));
        }
    }

    static void draw_entry(const VertexEntry& entry, bool with_colour)
    {
        std::vector<GLint> first;
        std::vector<GLsizei> count;
        const auto stride = static_cast<GLsizei>(entry.stride());
        for (std::size_t i = 0; i < entry.ranges.size();) {
            const std::uint32_t buffer = entry.ranges[i].buffer;
            first.clear();
            count.clear();
            for (; i < entry.ranges.size() && entry.ranges[i].buffer == buffer; ++i) {
                first.push_back(entry.ranges[i].first);
                count.push_back(entry.ranges[i].count);
            }
            glBindBuffer(GL_ARRAY_BUFFER, buffer);
            glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
            if (with_colour)
                glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, reinterpret_cast<const void*>(12));
            glMultiDrawArrays(GL_POINTS, first.data(), count.data(), static_cast<GLsizei>(first.size()));
        }
    }

    void draw_nodes(const DetailSelection& selection, const DrawSet& set, const Camera& camera,
                    const Vec3d& local_origin, const Vec3d& local_eye, const RenderOptions& options, ColourMode mode,
                    bool compatibility, FrameReport& report)
    {
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
        glEnable(GL_PROGRAM_POINT_SIZE);
        if (compatibility) {
            // Points of a core context, and sprites here, are squares of exactly the asked size. Plain legacy points
            // have size and place rounded to whole pixels, which for a whole size covers the very same pixels; and
            // Mesa's software rasteriser draws them twice as fast.
            const bool whole = options.point_size_px == std::floor(options.point_size_px);
            whole ? glDisable(GL_POINT_SPRITE) : glEnable(GL_POINT_SPRITE);
            glDisable(GL_POINT_SMOOTH);
        }
        // Not kept: contexts of a share group do not share vertex arrays.
        GLuint vertex_array = 0;
        glGenVertexArrays(1, &vertex_array);
        glBindVertexArray(vertex_array);
        glEnableVertexAttribArray(0);

        // An entry with the colours of another mode is drawn with those until its own have come; one without any is
        // drawn in one colour.
        const bool reads_colour = mode == ColourMode::rgb || mode == ColourMode::intensity;
        const auto pass = [&](const Program& program, bool with_colour) {
            bool prepared = false;
            for (const std::uint32_t i : set.drawn) {
                const VertexEntry* entry = feed->find(selection.wanted[i].node);
                if (!entry || (reads_colour && with_colour != (entry->format.colour != VertexColour::none))) continue;
                if (!prepared) set_common(program, camera, options);
                prepared = true;
                set_chunk(program, *entry, camera, local_origin, local_eye);
                draw_entry(*entry, with_colour);
                report.points_drawn += entry->points;
                ++report.nodes_drawn;
            }
        };
        if (reads_colour) {
            glEnableVertexAttribArray(1);
            pass(vertex_colour_program, true);
            glDisableVertexAttribArray(1);
            pass(uniform_program, false);
        } else {
            pass(mode == ColourMode::height ? height_program : uniform_program, false);
        }
        glBindVertexArray(0);
        glDeleteVertexArrays(1, &vertex_array);
    }

    FrameReport draw(const Camera& camera, const Vec3d& local_origin, const RenderOptions& options)
    {
        const auto start = Clock::now();
        FrameReport report;
        const ColourMode mode = usable_mode(options.colour);
        const VertexFormat colour = vertex_format(mode);
        report.colour_used = mode;

        View view;
        std::copy_n(camera.modelview, 16, view.modelview.begin());
        std::copy_n(camera.projection, 16, view.projection.begin());
        view.origin = local_origin;
        view.width = camera.viewport[2];
        view.height = camera.viewport[3];
        const auto frustum = Frustum::of(view);
        if (!frustum) return report;

        const auto& nodes = cloud->cache().tree().nodes();
        const bool resting = rests(camera, local_origin);
        const double budget_ms =
            resting ? std::max(options.rest_budget_ms, options.frame_budget_ms) : options.frame_budget_ms;
        DetailLimits limits;
        limits.target_px = options.target_spacing_px;
        limits.point_budget = budget.points(budget_ms, nodes.empty() ? 0 : nodes[0].points, options.point_budget);
        report.effective_point_budget = limits.point_budget;
        // Counted as if all entries had colour: those of another mode stay until there is need for their room.
        limits.page_points = L1Cache::points_per_page(VertexFormat{VertexColour::rgb});
        limits.page_budget = l1->pages_available(feed->owner());
        const DetailSelection selection = select_detail(cloud->cache().tree(), view, limits);

        l1->begin_frame(feed->owner());
        std::vector<bool> current(selection.wanted.size());
        for (std::size_t i = 0; i < selection.wanted.size(); ++i) {
            current[i] = ChunkFeed::is_current(l1->use(feed->owner(), selection.wanted[i].node), colour);
        }
        const std::vector<NodeId> window = feed->window_of(selection, current);
        std::optional<View> later;
        if (!resting && last_view && options.prefetch_frames) later = predict(*last_view, view, options.prefetch_frames);
        last_view = view;
        feed->load(window, later ? feed->ahead_of(select_detail(cloud->cache().tree(), *later, limits), window.size()) : std::vector<NodeId>(), colour);

        const GlStateGuard state;
        build_programs(state.compatibility());
        const Served uploads = feed->upload(window, colour, options.upload_budget_ms);

        const DrawSet set =
            choose_drawable(selection, [&](const DetailNode& node) { return feed->find(node.node) != nullptr; });
        // The first frames pay for the driver's compilation and tell nothing.
        const bool measure = frames_since_build >= 1 && !set.drawn.empty() && budget.wants_measure();
        ++frames_since_build;
        if (measure) glFinish();  // so that what the host and the uploads have queued is not counted
        const auto draw_start = Clock::now();
        const Vec3d eye = frustum->local_eye();
        draw_nodes(selection, set, camera, local_origin, eye, options, mode, state.compatibility(), report);
        if (measure) {
            glFinish();
            budget.measured(report.points_drawn, milliseconds_since(draw_start));
        } else if (!set.drawn.empty()) {
            budget.not_measured();
        }

        report.screen_error_px = set.error_px;
        report.nodes_wanted = selection.wanted.size();
        for (std::size_t i = 0; i < selection.wanted.size(); ++i) {
            current[i] = ChunkFeed::is_current(feed->find(selection.wanted[i].node), colour);
            report.nodes_missing += !current[i];
        }
        // What failed is missing for the time being and not waited for.
        const bool more_to_come = !uploads.refused && !feed->window_of(selection, current).empty();
        report.measured_ms = budget.last_measured_ms();
        const double rest_ms = std::max(options.rest_budget_ms, options.frame_budget_ms);
        const bool budget_grows = selection.budget_reached && limits.point_budget < options.point_budget &&
                                  budget.can_grow(rest_ms, options.point_budget);
        // Also when the window is through and the next one has not been asked for. When video memory refuses, waiting
        // helps nothing: it is full of what is on the screen.
        report.repaint = uploads.out_of_time || budget_grows || (more_to_come && !feed->waits());
        report.refining = report.repaint || more_to_come;
        if (selection.wanted.empty() && selection.budget_reached)
            report.error = "the point budget or the video memory is too small for the first chunk of " +
                           cloud->tree()->folder().string();
        if (const std::string error = feed->error(); !error.empty()) report.error = error;
        report.frame_ms = milliseconds_since(start);
        return report;
    }
};

CloudRenderer::CloudRenderer(std::shared_ptr<PointCloud> cloud, const L1Options& l1)
    : CloudRenderer(std::move(cloud), std::make_shared<L1Cache>(l1))
{
    impl_->l1_is_own = true;
}

CloudRenderer::CloudRenderer(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1)
    : impl_(std::make_unique<Impl>())
{
    impl_->cloud = std::move(cloud);
    impl_->l1 = std::move(l1);
    impl_->feed = std::make_unique<ChunkFeed>(impl_->cloud, impl_->l1);
}

CloudRenderer::~CloudRenderer() = default;

FrameReport CloudRenderer::draw(const Camera& camera, const Vec3d& local_origin, const RenderOptions& options)
{
    FrameReport report;
    if (!gl_functions_loaded()) {
        report.error = "OpenGL 3.3 is not available: its functions are not loaded (glewInit), or the driver lacks them";
        return report;
    }
    drain_gl_errors();
    std::string failure;
    try {
        report = impl_->draw(camera, local_origin, options);
    } catch (const std::exception& error) {
        failure = error.what();
    }
    const std::string gl_errors = drain_gl_errors();
    if (!gl_errors.empty()) report.error = "OpenGL error while drawing: " + gl_errors;
    if (!failure.empty()) report.error = failure;
    return report;
}

void CloudRenderer::set_wake(std::function<void()> wake) { impl_->feed->set_wake(std::move(wake)); }

void CloudRenderer::release()
{
    impl_->release_programs();
    impl_->feed->release();
    if (impl_->l1_is_own) impl_->l1->release();
}

const std::shared_ptr<PointCloud>& CloudRenderer::cloud() const { return impl_->cloud; }

const std::shared_ptr<L1Cache>& CloudRenderer::l1() const { return impl_->l1; }

}  // namespace pcm
