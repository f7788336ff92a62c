#include "plugin/scene/text.h"

#include <exception>
#include <new>

namespace pcm::host {

std::string current_error()
{
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return "not enough memory";
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "an unknown error occurred";
    }
}

}  // namespace pcm::host
