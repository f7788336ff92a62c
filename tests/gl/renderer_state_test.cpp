// What the renderer promises to its host: OpenGL's state, shared contexts, views that show nothing.
#include "tests/gl/gl_support.h"

#include <cmath>
#include <memory>
#include <optional>
#include <string>

using namespace pcm;
using namespace pcm::test;

class RendererStateIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, RendererStateIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

TEST_P(RendererStateIn, LeavesTheStateOfTheHostAsItWas)
{
    PCM_REQUIRE_GL(context, GetParam());
    const bool compatibility = GetParam() == Profile::compatibility;
    const TemporaryFolder folder;
    Drawing renderer(make_cloud(folder, "cube", grid_at(map_offset), random_points(5000, 10000, 4)));
    const Framebuffer framebuffer(64, 64);
    GLuint array = 0;
    GLuint buffers[3] = {};
    glGenVertexArrays(1, &array);
    glGenBuffers(3, buffers);
    GLuint textures[2] = {};
    glGenTextures(2, textures);

    std::vector<GLenum> integers{GL_CURRENT_PROGRAM,
                                 GL_VERTEX_ARRAY_BINDING,
                                 GL_ARRAY_BUFFER_BINDING,
                                 GL_ELEMENT_ARRAY_BUFFER_BINDING,
                                 GL_COPY_WRITE_BUFFER,
                                 GL_COPY_READ_BUFFER,
                                 GL_PIXEL_UNPACK_BUFFER_BINDING,
                                 GL_UNIFORM_BUFFER_BINDING,
                                 GL_DEPTH_FUNC,
                                 GL_DEPTH_WRITEMASK,
                                 GL_DRAW_FRAMEBUFFER_BINDING,
                                 GL_READ_FRAMEBUFFER_BINDING,
                                 GL_ACTIVE_TEXTURE,
                                 GL_TEXTURE_BINDING_2D,
                                 GL_BLEND_SRC_RGB,
                                 GL_BLEND_DST_ALPHA,
                                 GL_BLEND_EQUATION_RGB,
                                 GL_DEPTH_RANGE,
                                 GL_COLOR_CLEAR_VALUE,
                                 GL_DEPTH_CLEAR_VALUE,
                                 GL_RENDERBUFFER_BINDING,
                                 GL_TEXTURE_BINDING_2D_MULTISAMPLE,
                                 GL_SAMPLER_BINDING,
                                 GL_CLIP_DEPTH_MODE,
                                 GL_CLIP_ORIGIN,
                                 GL_CULL_FACE_MODE,
                                 GL_FRONT_FACE,
                                 GL_POLYGON_MODE,
                                 GL_VIEWPORT,
                                 GL_SCISSOR_BOX,
                                 GL_COLOR_WRITEMASK,
                                 GL_UNPACK_ALIGNMENT,
                                 GL_POINT_SPRITE_COORD_ORIGIN};
    std::vector<GLenum> switches{
        GL_DEPTH_TEST,  GL_BLEND,  GL_PROGRAM_POINT_SIZE, GL_CULL_FACE,          GL_SCISSOR_TEST, GL_STENCIL_TEST,
        GL_MULTISAMPLE, GL_DITHER, GL_LINE_SMOOTH,        GL_POLYGON_OFFSET_FILL};
    if (compatibility) {
        for (const GLenum e :
             {GL_MATRIX_MODE, GL_ATTRIB_STACK_DEPTH, GL_CLIENT_ATTRIB_STACK_DEPTH, GL_MODELVIEW_STACK_DEPTH,
              GL_PROJECTION_STACK_DEPTH, GL_SHADE_MODEL, GL_CLIENT_ACTIVE_TEXTURE})
            integers.push_back(static_cast<GLenum>(e));
        for (const GLenum e : {GL_POINT_SPRITE, GL_POINT_SMOOTH, GL_LIGHTING, GL_ALPHA_TEST, GL_COLOR_MATERIAL,
                               GL_NORMALIZE, GL_VERTEX_ARRAY, GL_COLOR_ARRAY, GL_TEXTURE_2D})
            switches.push_back(static_cast<GLenum>(e));
    }
    const auto snapshot = [&] {
        std::vector<double> state;
        for (const GLenum name : integers) {
            GLint values[16] = {};
            glGetIntegerv(name, values);
            state.insert(state.end(), values, values + 16);
        }
        for (const GLenum name : switches) state.push_back(glIsEnabled(name));
        GLfloat size = 0;
        glGetFloatv(GL_POINT_SIZE, &size);
        state.push_back(size);
        GLint enabled = 0;
        if (array) glGetVertexAttribiv(0, GL_VERTEX_ATTRIB_ARRAY_ENABLED, &enabled);
        state.push_back(enabled);
        if (compatibility) {
            GLdouble matrix[16];
            glGetDoublev(GL_MODELVIEW_MATRIX, matrix);
            state.insert(state.end(), matrix, matrix + 16);
            GLfloat colour[4];
            glGetFloatv(GL_CURRENT_COLOR, colour);
            state.insert(state.end(), colour, colour + 4);
        }
        return state;
    };

    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 64, 64);
    for (int host = 0; host < 4; ++host) {
        const auto toggle = [&](GLenum what, bool on) { on ? glEnable(what) : glDisable(what); };
        const bool odd = host % 2;
        toggle(GL_DEPTH_TEST, odd);
        toggle(GL_BLEND, odd);
        toggle(GL_PROGRAM_POINT_SIZE, odd);
        if (compatibility) {
            toggle(GL_POINT_SPRITE, odd);
            toggle(GL_POINT_SMOOTH, !odd);
            glPointSize(3.5f);
        }
        toggle(GL_SCISSOR_TEST, odd);
        toggle(GL_STENCIL_TEST, odd);
        toggle(GL_CULL_FACE, odd);
        glScissor(3, 4, 5, 6);
        glCullFace(GL_FRONT_AND_BACK);
        glBlendFuncSeparate(GL_ONE, GL_ZERO, GL_DST_ALPHA, GL_ONE);
        glBlendEquation(odd ? GL_FUNC_SUBTRACT : GL_FUNC_ADD);
        glPolygonMode(GL_FRONT_AND_BACK, odd ? GL_LINE : GL_FILL);
        glColorMask(GL_TRUE, odd ? GL_FALSE : GL_TRUE, GL_TRUE, GL_TRUE);
        glClearColor(0.25f, 0.5f, 0.75f, 1);
        glDepthRange(odd ? 0.25 : 0, odd ? 0.5 : 1);
        const GLenum units[] = {GL_TEXTURE0, GL_TEXTURE2, GL_TEXTURE0, GL_TEXTURE1};
        glActiveTexture(units[host]);
        glBindTexture(GL_TEXTURE_2D, textures[odd]);
        glDepthFunc(odd ? GL_GEQUAL : GL_LEQUAL);
        glDepthMask(odd ? GL_FALSE : GL_TRUE);
        glBindVertexArray(host >= 2 ? array : 0);
        glBindBuffer(GL_ARRAY_BUFFER, odd ? buffers[0] : 0);
        glBindBuffer(GL_COPY_WRITE_BUFFER, odd ? buffers[1] : 0);
        for (const ColourMode mode :
             {ColourMode::rgb, ColourMode::intensity, ColourMode::height, ColourMode::uniform}) {
            while (glGetError() != GL_NO_ERROR) {
            }
            const auto before = snapshot();
            while (glGetError() != GL_NO_ERROR) {
            }                  // core contexts do not know all of the names
            glEnable(0xdead);  // an error left by the host is not reported as the renderer's
            RenderOptions options = everything();
            renderer.style.colour = mode;
            // Every option is on in one of the hosts.
            options.samples = host >= 2 ? 4 : 1;
            options.eye_dome = odd ? 1.0f : 0.0f;
            options.smooth_frames = host == 1 || host == 2 ? 4 : 1;
            FrameReport report;
            for (int frame = 0; frame < 200; ++frame) {
                report = renderer.draw(camera, map_offset, options);
                EXPECT_EQ(report.error, "");
                EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
                ASSERT_EQ(snapshot(), before) << "host " << host << ", mode " << name_of(mode) << ", frame " << frame;
                while (glGetError() != GL_NO_ERROR) {
                }
                if (!report.refining) break;
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            EXPECT_FALSE(report.refining);
            EXPECT_EQ(report.points_drawn, 5000u);
            EXPECT_EQ(report.clouds[0].style.colour, mode);
        }
    }
    renderer.release();
    glDeleteVertexArrays(1, &array);
    glDeleteBuffers(3, buffers);
    glDeleteTextures(2, textures);
}

TEST(RendererState, ContextsOfOneGroupTakeTurns)
{
    std::string why;
    const auto first = make_offscreen(16, 16, why);
    if (!first) GTEST_SKIP() << why;
    const auto second = make_offscreen(16, 16, why, Profile::compatibility, first.get());
    ASSERT_TRUE(second) << why;
    const TemporaryFolder folder;
    Drawing renderer(make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, 10000, 10), 2000));
    const Camera camera = view_of(overview(10), perspective(0.9, 1, 0.1, 1000), 100, 100);
    second->make_current();
    auto in_second = std::make_unique<Framebuffer>(100, 100);
    Picture of_second;  // a picture belongs to one context
    first->make_current();
    auto in_first = std::make_unique<Framebuffer>(100, 100);
    draw_until_done(renderer, *in_first, camera, map_offset, everything());
    const auto picture = in_first->read();
    const std::uint64_t uploaded = renderer.l1()->statistics().uploaded_bytes;
    for (int turn = 0; turn < 4; ++turn) {
        (turn % 2 ? first : second)->make_current();
        if (turn % 2 == 0) std::swap(renderer.picture, of_second);
        const Framebuffer& framebuffer = turn % 2 ? *in_first : *in_second;
        framebuffer.bind();
        framebuffer.clear();
        EXPECT_EQ(renderer.draw(camera, map_offset, everything()).points_drawn, 20000u);
        EXPECT_TRUE(framebuffer.read() == picture) << "turn " << turn;
        if (turn % 2 == 0) std::swap(renderer.picture, of_second);
    }
    EXPECT_EQ(renderer.l1()->statistics().uploaded_bytes, uploaded);
    renderer.picture.release();
    in_first.reset();
    second->make_current();
    of_second.release();
    in_second.reset();
    renderer.release();  // in another context of the group than the one that uploaded
    EXPECT_EQ(renderer.l1()->statistics().allocated_bytes, 0u);
}

// A small cloud and a framebuffer, for views that show nothing of it.
class ViewsThatShowNothing : public testing::Test {
protected:
    void SetUp() override
    {
        std::string why;
        context_ = make_offscreen(16, 16, why, Profile::core);
        if (!context_) GTEST_SKIP() << why;
        drawing_.emplace(make_cloud(folder_, "cube", grid_at(map_offset), random_points(1000, 10000, 13)));
        framebuffer_.emplace(50, 50);
    }
    // The context is the last to go.
    void TearDown() override
    {
        if (drawing_) drawing_->release();
        framebuffer_.reset();
        drawing_.reset();
    }
    static Camera camera_of(const Matrix& modelview, int width = 50, int height = 50)
    {
        return view_of(modelview, perspective(0.9, 1, 0.1, 1000), width, height);
    }
    void expect_nothing(const Camera& camera)
    {
        const FrameReport report = drawing_->draw(camera, map_offset, everything());
        EXPECT_EQ(report.error, "");
        EXPECT_EQ(report.points_drawn, 0u);
        EXPECT_EQ(report.nodes_wanted, 0u);
        EXPECT_EQ(report.screen_error_px, 0);
        EXPECT_FALSE(report.refining);
        EXPECT_EQ(drawing_->l1()->statistics().allocated_bytes, 0u);
        EXPECT_EQ(count_lit(framebuffer_->read()), 0u);
    }

private:
    const TemporaryFolder folder_;
    std::unique_ptr<Offscreen> context_;
    std::optional<Drawing> drawing_;
    std::optional<Framebuffer> framebuffer_;
};

TEST_F(ViewsThatShowNothing, ACameraThatIsNotANumber)
{
    Camera camera = camera_of(overview(10));
    camera.modelview[0] = std::nan("");
    expect_nothing(camera);
}

TEST_F(ViewsThatShowNothing, APictureWithoutPixels) { expect_nothing(camera_of(overview(10), 0, 0)); }

TEST_F(ViewsThatShowNothing, ACloudBehindTheEye)
{
    expect_nothing(camera_of(product(translation(0, 0, 300), overview(10))));
}
