// How two pictures differ: compare_pictures A B prints the share of pixels that differ by more than 8 of 255 in some channel, and
// the share of drawn pixels (those unlike the corner's colour column by column) in each, as one line of JSON.
#include <QImage>

#include <cstdio>
#include <cstdlib>

namespace {

QImage load(const char* name)
{
    QImage image(name);
    if (image.isNull()) {
        std::fprintf(stderr, "compare_pictures: cannot read %s\n", name);
        std::exit(2);
    }
    return image.convertToFormat(QImage::Format_RGB32);
}

bool differ(QRgb a, QRgb b, int by)
{
    return std::abs(qRed(a) - qRed(b)) > by || std::abs(qGreen(a) - qGreen(b)) > by || std::abs(qBlue(a) - qBlue(b)) > by;
}

// MeshLab's background changes from top to bottom only: the left edge shows it, if nothing is drawn there.
double drawn(const QImage& image)
{
    qint64 count = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) count += differ(image.pixel(x, y), image.pixel(0, y), 12);
    return double(count) / image.width() / image.height();
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: compare_pictures A B\n");
        return 2;
    }
    const QImage a = load(argv[1]), b = load(argv[2]);
    double different = 1;
    if (a.size() == b.size()) {
        qint64 count = 0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) count += differ(a.pixel(x, y), b.pixel(x, y), 8);
        different = double(count) / a.width() / a.height();
    }
    std::printf("{\"different\": %.6f, \"drawn\": [%.6f, %.6f], \"same_size\": %s}\n", different, drawn(a), drawn(b),
                a.size() == b.size() ? "true" : "false");
    return 0;
}
