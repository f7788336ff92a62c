// Writes a picture to the file that it is given: image_test.cpp runs it while the system fails it.
#include "pcm/offscreen/image.h"

#include <cstdio>
#include <exception>

int main(int, char** argv)
{
    try {
        pcm::write_png(argv[1], {2, 1, {255, 0, 0, 255, 0, 0, 255, 255}});
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
