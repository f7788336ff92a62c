#include "pcm/offscreen/offscreen.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/system/error.h"

#include <GL/glew.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <vector>

namespace pcm {
namespace {

std::string text_of(GLenum name)
{
    const auto* const text = reinterpret_cast<const char*>(glGetString(name));
    return text ? text : "";
}

template <class Function>
Function egl_function(const char* name)
{
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

// Displays to try, best first: each device, then Mesa's surfaceless platform, then the default.
std::vector<EGLDisplay> displays()
{
    std::vector<EGLDisplay> found;
    const auto of_platform = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    const auto devices_of = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    if (of_platform && devices_of) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (devices_of(static_cast<EGLint>(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count; ++i)
                found.push_back(of_platform(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
    }
    if (of_platform) found.push_back(of_platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    found.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return found;
}

}  // namespace

struct Offscreen::Impl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    GLuint framebuffer = 0, colour = 0, depth = 0;
    int width = 0, height = 0;
    OffscreenProfile profile = OffscreenProfile::compatibility;
    const Impl* share = nullptr;

    bool make(EGLDisplay on)
    {
        if (on == EGL_NO_DISPLAY || !eglInitialize(on, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return false;
        const EGLint mask = profile == OffscreenProfile::core ? EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT
                                                              : EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT;
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     3,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     mask,
                                     EGL_NONE};
        const EGLContext made =
            eglCreateContext(on, EGL_NO_CONFIG_KHR, share ? share->context : EGL_NO_CONTEXT, attributes);
        if (made == EGL_NO_CONTEXT) return false;
        if (!eglMakeCurrent(on, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
            eglDestroyContext(on, made);
            return false;
        }
        display = on;
        context = made;
        glewExperimental = GL_TRUE;
        glewInit();  // reports that there is no GLX display, after having loaded the functions
        drain_gl_errors();
        return gl_functions_loaded();
    }

    void make_best()
    {
        // Searched once per process: a context on every display takes longer than drawing a small picture.
        static std::mutex mutex;
        static std::array<EGLDisplay, 2> best_of_profiles{EGL_NO_DISPLAY, EGL_NO_DISPLAY};
        const std::lock_guard lock(mutex);
        EGLDisplay& best = best_of_profiles[profile == OffscreenProfile::core];
        if (share || best != EGL_NO_DISPLAY) {
            if (!make(share ? share->display : best)) fail();
            return;
        }
        for (const EGLDisplay on : displays()) {
            if (make(on)) {
                best = on;  // the last of several software displays: it needs least of the machine
                if (!gl_is_software()) return;
            }
            destroy();
        }
        if (best == EGL_NO_DISPLAY || !make(best)) fail();
    }

    [[noreturn]] void fail()
    {
        const EGLint error = eglGetError();
        destroy();
        throw Error(ErrorCode::unsupported, {},
                    "no OpenGL context: EGL finds no device or software renderer with OpenGL 3.3 (last error " +
                        std::to_string(error) + ")",
                    "on Debian and derivatives: apt-get install libegl1 libgl1-mesa-dri, which draws without a "
                    "graphics card too");
    }

    void make_framebuffer()
    {
        GLint largest = 0, viewport[2] = {0, 0};
        glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
        glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
        largest = std::min({largest, viewport[0], viewport[1]});
        const std::string size = std::to_string(width) + " x " + std::to_string(height);
        if (width < 1 || height < 1 || width > largest || height > largest)
            throw Error(
                ErrorCode::invalid_argument, {},
                "a picture of " + size + " pixels; this driver draws 1 to " + std::to_string(largest) + " each way");
        glGenFramebuffers(1, &framebuffer);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glGenRenderbuffers(1, &colour);
        glBindRenderbuffer(GL_RENDERBUFFER, colour);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
        glGenRenderbuffers(1, &depth);
        glBindRenderbuffer(GL_RENDERBUFFER, depth);
        glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR) {
            drain_gl_errors();
            throw Error(ErrorCode::invalid_argument, {}, "this driver cannot draw a picture of " + size + " pixels",
                        "memory may be short: try a smaller one");
        }
        glViewport(0, 0, width, height);
    }

    void destroy()
    {
        if (context == EGL_NO_CONTEXT) return;
        if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, context);
        context = EGL_NO_CONTEXT;
    }

    ~Impl() { destroy(); }
};

Offscreen::Offscreen(int width, int height, OffscreenProfile profile, const Offscreen* share)
    : impl_(std::make_unique<Impl>())
{
    impl_->width = width;
    impl_->height = height;
    impl_->profile = profile;
    impl_->share = share ? share->impl_.get() : nullptr;
    impl_->make_best();
    impl_->share = nullptr;  // it may be destroyed first
    impl_->make_framebuffer();
}

Offscreen::~Offscreen() = default;

void Offscreen::make_current() const
{
    eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context);
    glBindFramebuffer(GL_FRAMEBUFFER, impl_->framebuffer);
}

int Offscreen::width() const { return impl_->width; }
int Offscreen::height() const { return impl_->height; }

void Offscreen::clear(const std::array<float, 4>& colour) const
{
    glClearColor(colour[0], colour[1], colour[2], colour[3]);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

Image Offscreen::read() const
{
    Image image;
    image.width = impl_->width;
    image.height = impl_->height;
    const std::size_t row = 4 * static_cast<std::size_t>(image.width), rows = static_cast<std::size_t>(image.height);
    std::vector<std::uint8_t> upwards(row * rows);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, upwards.data());
    image.rgba.resize(upwards.size());
    for (std::size_t y = 0; y < rows; ++y) std::memcpy(&image.rgba[y * row], &upwards[(rows - 1 - y) * row], row);
    return image;
}

std::string Offscreen::renderer() const { return text_of(GL_RENDERER) + ", OpenGL " + text_of(GL_VERSION); }

}  // namespace pcm
