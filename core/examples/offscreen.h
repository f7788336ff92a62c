// An OpenGL context without a window or a display server, by EGL, and compute programs in it.
#pragma once

#include <GL/glew.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdexcept>
#include <string>

// Current on the thread that made it, while it lives.
class Offscreen {
public:
    Offscreen()
    {
        // Mesa's platform without a surface, where there is one: it asks for no display.
        const auto platform_display =
            reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
        if (platform_display) display_ = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) {
            display_ = eglGetDisplay(EGL_DEFAULT_DISPLAY);
            if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) fail("finds no display");
        }
        if (!eglBindAPI(EGL_OPENGL_API)) fail("has no desktop OpenGL");
        const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
        context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version);
        if (context_ == EGL_NO_CONTEXT || !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            fail("gives no context of OpenGL 4.3");
        glewExperimental = GL_TRUE;
        glewInit();  // says that there is no X display, after having loaded the functions
        if (!glDispatchCompute) fail("gives a context, but OpenGL's functions are not there");
    }
    ~Offscreen()
    {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
    }
    Offscreen(const Offscreen&) = delete;
    Offscreen& operator=(const Offscreen&) = delete;

private:
    [[noreturn]] static void fail(const std::string& what)
    {
        throw std::runtime_error("no OpenGL context: EGL " + what + ", error " + std::to_string(eglGetError()));
    }
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

inline GLuint compute_program(const char* source)
{
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    const GLuint program = glCreateProgram();
    glAttachShader(program, shader);
    glLinkProgram(program);
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    if (!linked) throw std::runtime_error(std::string("the compute shader does not compile:\n") + log);
    glDeleteShader(shader);
    return program;
}
