#include "pcm/gl/draw/frame_clock.h"

#include "pcm/gl/base/gl_state.h"

#include <GL/glew.h>

#include <algorithm>

namespace pcm {
namespace {

bool has_useful_queries()
{
    if (!glQueryCounter || !glGetQueryObjectui64v || gl_is_software()) return false;
    GLint bits = 0;
    glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    return bits > 0;
}

}  // namespace

void FrameClock::begin()
{
    if (!decided_) queries_are_used_ = has_useful_queries();
    decided_ = true;
    if (!queries_are_used_) glFinish();  // excludes what the host and the uploads have queued
    start_ = Clock::now();
    if (!queries_are_used_) return;
    Span& span = spans_[next_];
    open_ = !span.pending;  // all are pending: this frame is not measured
    if (!open_) return;
    if (span.from == 0) {
        glGenQueries(1, &span.from);
        glGenQueries(1, &span.to);
    }
    glQueryCounter(span.from, GL_TIMESTAMP);
}

void FrameClock::end(const FrameWork& work)
{
    if (!queries_are_used_) glFinish();
    const double milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    if (!queries_are_used_) known_ = Measure{work, milliseconds};
    if (!queries_are_used_ || !open_) return;
    Span& span = spans_[next_];
    glQueryCounter(span.to, GL_TIMESTAMP);
    span.work = work;
    span.handing_ms = milliseconds;
    span.pending = true;
    next_ = (next_ + 1) % spans_.size();
    open_ = false;
}

std::optional<FrameClock::Measure> FrameClock::take()
{
    if (queries_are_used_) {
        for (std::size_t k = 0; k < spans_.size(); ++k) {  // oldest first
            Span& span = spans_[(next_ + k) % spans_.size()];
            if (!span.pending) continue;
            GLuint there = GL_FALSE;
            glGetQueryObjectuiv(span.to, GL_QUERY_RESULT_AVAILABLE, &there);
            if (!there) break;
            GLuint64 from = 0, to = 0;
            glGetQueryObjectui64v(span.from, GL_QUERY_RESULT, &from);
            glGetQueryObjectui64v(span.to, GL_QUERY_RESULT, &to);
            span.pending = false;
            if (to >= from)
                known_ = Measure{span.work, std::max(span.handing_ms, static_cast<double>(to - from) * 1e-6)};
        }
    }
    const std::optional<Measure> result = known_;
    known_.reset();
    return result;
}

void FrameClock::release()
{
    for (Span& span : spans_) {
        if (span.from) {
            glDeleteQueries(1, &span.from);
            glDeleteQueries(1, &span.to);
        }
        span = {};
    }
    next_ = 0;
    open_ = false;
    known_.reset();
}

}  // namespace pcm
