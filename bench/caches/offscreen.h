// An OpenGL context without a window, and a picture to draw into.
#pragma once

#include <memory>
#include <string>

namespace pcm::bench {

class Offscreen {
public:
    // On a device of its own where EGL knows one that is no software, else on Mesa's software rasteriser. Current on the calling
    // thread until it dies. Throws std::runtime_error where there is no OpenGL 3.3.
    Offscreen(int width, int height);
    ~Offscreen();
    Offscreen(const Offscreen&) = delete;
    Offscreen& operator=(const Offscreen&) = delete;

    void clear() const;
    std::string renderer() const;  // as the driver calls itself, with the version
    bool is_software() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm::bench
