#include "pcm/gl/base/shader_program.h"

#include "pcm/system/error.h"

#include <GL/glew.h>

#include <algorithm>
#include <utility>

namespace pcm {

namespace {

std::string_view text_of(std::string_view file)
{
    for (const ShaderSource& source : shader_sources())
        if (source.file == file) return source.text;
    throw Error(ErrorCode::not_found, std::string(file), "no such shader in the library");
}

std::string log_of(GLuint object, bool is_program)
{
    GLint length = 0;
    is_program ? glGetProgramiv(object, GL_INFO_LOG_LENGTH, &length)
               : glGetShaderiv(object, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    GLsizei written = 0;
    is_program ? glGetProgramInfoLog(object, length, &written, log.data())
               : glGetShaderInfoLog(object, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log.empty() ? "the driver gives no reason" : log;
}

std::string permutation(const std::vector<std::string>& defines)
{
    std::string text;
    for (const std::string& define : defines) text += (text.empty() ? " with " : ", ") + define;
    return text;
}

GLuint compile(GLenum stage, std::string_view file, const std::vector<std::string>& defines)
{
    const std::string_view text = text_of(file);
    const std::size_t first_line = text.find('\n') + 1;  // #version must stay first
    std::string source(text.substr(0, first_line));
    for (const std::string& define : defines) source += "#define " + define + "\n";
    source += "#line 2\n";
    source += text.substr(first_line);

    const GLuint shader = glCreateShader(stage);
    const char* pointer = source.c_str();
    glShaderSource(shader, 1, &pointer, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        const std::string log = log_of(shader, false);
        glDeleteShader(shader);
        throw Error(ErrorCode::unsupported, std::string(file),
                    "the driver cannot compile the shader" + permutation(defines) + ": " + log);
    }
    return shader;
}

// Deletes the shaders.
GLuint link(const std::vector<GLuint>& shaders, const std::string& files, const std::vector<std::string>& defines)
{
    const GLuint program = glCreateProgram();
    for (const GLuint shader : shaders) glAttachShader(program, shader);
    glLinkProgram(program);
    for (const GLuint shader : shaders) {
        glDetachShader(program, shader);
        glDeleteShader(shader);
    }
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) return program;
    const std::string log = log_of(program, true);
    glDeleteProgram(program);
    throw Error(ErrorCode::unsupported, files,
                "the driver cannot link the program" + permutation(defines) + ": " + log);
}

}  // namespace

ShaderProgram::ShaderProgram(std::string_view vertex_file, std::string_view fragment_file,
                             const std::vector<std::string>& defines)
{
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_file, defines);
    GLuint fragment = 0;
    try {
        fragment = compile(GL_FRAGMENT_SHADER, fragment_file, defines);
    } catch (...) {
        glDeleteShader(vertex);
        throw;
    }
    program_ = link({vertex, fragment}, std::string(vertex_file) + "+" + std::string(fragment_file), defines);
}

ShaderProgram ShaderProgram::compute(std::string_view file, const std::vector<std::string>& defines)
{
    ShaderProgram program;
    program.program_ = link({compile(GL_COMPUTE_SHADER, file, defines)}, std::string(file), defines);
    return program;
}

ShaderProgram::ShaderProgram(ShaderProgram&& other) noexcept : program_(std::exchange(other.program_, 0u)) {}

ShaderProgram& ShaderProgram::operator=(ShaderProgram&& other) noexcept
{
    std::swap(program_, other.program_);
    return *this;
}

std::int32_t ShaderProgram::uniform(const char* name) const { return glGetUniformLocation(program_, name); }

void ShaderProgram::release()
{
    if (program_) glDeleteProgram(program_);
    program_ = 0;
}

}  // namespace pcm
