// A compute shader, compiled and linked.
#pragma once

#include <GL/glew.h>

#include <stdexcept>
#include <string>

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
