// compare_pictures A B [BORDER] prints, as one line of JSON, the fraction of pixels that differ by more than 8 of 255
// in some channel. A border of BORDER pixels is ignored. The fraction is 1 for pictures of different sizes.
#include <QImage>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr int tolerance = 8;

QImage load(const char* name)
{
    QImage image(name);
    if (image.isNull()) {
        std::fprintf(stderr, "compare_pictures: cannot read %s\n", name);
        std::exit(2);
    }
    return image.convertToFormat(QImage::Format_RGB32);
}

bool differ(QRgb a, QRgb b)
{
    return std::abs(qRed(a) - qRed(b)) > tolerance || std::abs(qGreen(a) - qGreen(b)) > tolerance ||
           std::abs(qBlue(a) - qBlue(b)) > tolerance;
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 3 && argc != 4) {
        std::fprintf(stderr, "usage: compare_pictures A B [BORDER]\n");
        return 2;
    }
    const int border = argc == 4 ? std::atoi(argv[3]) : 0;
    const QImage a = load(argv[1]), b = load(argv[2]);
    double different = 1;
    if (a.size() == b.size() && 2 * border < std::min(a.width(), a.height())) {
        qint64 count = 0;
        for (int y = border; y < a.height() - border; ++y)
            for (int x = border; x < a.width() - border; ++x) count += differ(a.pixel(x, y), b.pixel(x, y));
        different = double(count) / (a.width() - 2 * border) / (a.height() - 2 * border);
    }
    std::printf("{\"different\": %.6f, \"same_size\": %s}\n", different, a.size() == b.size() ? "true" : "false");
    return 0;
}
