// A script of AutoCAD's commands, by which shapes are drawn as solids.
//
// A line is an input, an empty line the key Enter. Commands and options have the names that every language knows ("_"),
// commands those that nobody has redefined ("."). "_NON" before a place keeps object snaps from moving it. Numbers are
// written without exponents, with all digits. So that map coordinates cost no digits, the coordinate system is moved to
// the primitive first, then turned.
#pragma once

#include "pcm/cloud/vector.h"

#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

namespace pcm {

class CommandScript {
public:
    // `write` is called with each line and its end.
    explicit CommandScript(std::function<void(const std::string&)> write) : write_(std::move(write)) {}

    void comment(const std::string& text);  // on one line, whatever the text holds
    void line(const std::string& text) { write_(text + "\r\n"); }
    void lines(std::initializer_list<std::string> texts);
    void place(const Vec3d& p) { lines({"_NON", decimal(p)}); }
    // The origin, and two axes at right angles.
    void coordinate_system(const Vec3d& origin, const Vec3d& x, const Vec3d& y);

    static std::string decimal(double value);
    static std::string decimal(const Vec3d& v);

private:
    std::function<void(const std::string&)> write_;
};

}  // namespace pcm
