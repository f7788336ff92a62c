// A linked GLSL program, built from the sources in shaders/ that are embedded in the library.
//
// GL thread only. Programs are shared by the contexts of a share group.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

struct ShaderSource {
    std::string_view file;  // "splat.vert"
    std::string_view text;
};
const std::vector<ShaderSource>& shader_sources();

class ShaderProgram {
public:
    ShaderProgram() = default;
    // `defines` are the permutation: each becomes a #define after the #version line; line numbers in the driver's log
    // are those of the file. Throws Error(unsupported) with file, permutation and the driver's log, Error(not_found)
    // for a file that is not embedded.
    ShaderProgram(std::string_view vertex_file, std::string_view fragment_file,
                  const std::vector<std::string>& defines = {});
    // Of a compute shader; the context runs them (require_compute_shaders()). The same errors.
    static ShaderProgram compute(std::string_view file, const std::vector<std::string>& defines = {});
    ShaderProgram(ShaderProgram&& other) noexcept;
    ShaderProgram& operator=(ShaderProgram&& other) noexcept;
    // Makes no OpenGL call, as no context may be current; release() frees the program.
    ~ShaderProgram() = default;

    explicit operator bool() const { return program_ != 0; }
    std::uint32_t id() const { return program_; }
    // -1, which OpenGL ignores, for a uniform that the permutation does not use.
    std::int32_t uniform(const char* name) const;
    void release();

private:
    std::uint32_t program_ = 0;
};

}  // namespace pcm
