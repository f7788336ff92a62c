#include "offscreen.h"

#include <GL/glew.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace pcm::bench {
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

// Those to try, best first: each device, then what Mesa draws without one, then the default.
std::vector<EGLDisplay> displays()
{
    std::vector<EGLDisplay> found;
    const auto of_platform = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    const auto devices_of = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    if (of_platform && devices_of) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (devices_of(static_cast<EGLint>(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count; ++i) found.push_back(of_platform(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
    }
    if (of_platform) found.push_back(of_platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    found.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return found;
}

bool software(const std::string& renderer)
{
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

}  // namespace

struct Offscreen::Impl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    GLuint framebuffer = 0, colour = 0, depth = 0;

    bool make(EGLDisplay on)
    {
        if (on == EGL_NO_DISPLAY || !eglInitialize(on, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return false;
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,       3,
                                     EGL_CONTEXT_MINOR_VERSION,       3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT,
                                     EGL_NONE};
        const EGLContext made = eglCreateContext(on, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
        if (made == EGL_NO_CONTEXT) return false;
        if (!eglMakeCurrent(on, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
            eglDestroyContext(on, made);
            return false;
        }
        display = on;
        context = made;
        glewExperimental = GL_TRUE;
        glewInit();  // complains that there is no GLX display, after having loaded the functions
        while (glGetError() != GL_NO_ERROR) {
        }
        return glGenFramebuffers != nullptr;
    }
    void destroy()
    {
        if (context == EGL_NO_CONTEXT) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, context);
        context = EGL_NO_CONTEXT;
    }
};

Offscreen::Offscreen(int width, int height) : impl_(std::make_unique<Impl>())
{
    Impl& i = *impl_;
    EGLDisplay best = EGL_NO_DISPLAY;
    for (const EGLDisplay display : displays()) {
        if (i.make(display)) {
            if (!software(text_of(GL_RENDERER))) {
                best = display;
                break;
            }
            best = display;  // software: the later ones ask for less of the machine
        }
        i.destroy();
    }
    if (best == EGL_NO_DISPLAY || (i.context == EGL_NO_CONTEXT && !i.make(best)))
        throw std::runtime_error("no OpenGL 3.3 through EGL on this machine");
    glGenFramebuffers(1, &i.framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, i.framebuffer);
    glGenRenderbuffers(1, &i.colour);
    glBindRenderbuffer(GL_RENDERBUFFER, i.colour);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, i.colour);
    glGenRenderbuffers(1, &i.depth);
    glBindRenderbuffer(GL_RENDERBUFFER, i.depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, i.depth);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error("no picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels can be drawn into");
    glViewport(0, 0, width, height);
}

Offscreen::~Offscreen() { impl_->destroy(); }

void Offscreen::clear() const
{
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

std::string Offscreen::renderer() const { return text_of(GL_RENDERER) + ", OpenGL " + text_of(GL_VERSION); }

bool Offscreen::is_software() const { return software(text_of(GL_RENDERER)); }

}  // namespace pcm::bench
