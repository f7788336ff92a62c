// Damaged files must be read or refused, never crash, and never allocate memory because of a header alone.
#include "tests/io/las_file.h"
#include "tests/io/lzf.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// The largest single allocation since it was last set to 0.
std::atomic<std::size_t> largest_allocation{0};

}  // namespace

// Not inlined: the compiler would see malloc and delete, or new and free, together and warn.
[[gnu::noinline]] void* operator new(std::size_t size)
{
    std::size_t before = largest_allocation.load();
    while (size > before && !largest_allocation.compare_exchange_weak(before, size)) {
    }
    if (void* memory = std::malloc(size ? size : 1)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace pcm::test {
namespace {

std::vector<std::string> las_seeds()
{
    std::mt19937_64 random(1);
    std::vector<std::string> seeds;
    for (const auto& [version, format] : {std::pair{0, 0}, {2, 2}, {3, 5}, {4, 10}}) {
        LasFile file = random_las(random, version, format, 6, 12);
        file.vlrs = {
            {"LASF_Projection", 34735, "abcdefgh"},
            {"LASF_Spec", 4, extra_descriptor(5, 0x18, "a", {1, 1, 1}) + extra_descriptor(23, 8, "b", {1, 2, 3})}};
        if (version == 4) file.evlrs = {{"far", 1, "abcdefgh"}};
        seeds.push_back(file.bytes());
    }
    return seeds;
}

std::vector<std::string> ply_seeds()
{
    Bytes lists, plain;
    lists.raw(
        "ply\nformat binary_big_endian 1.0\nelement face 2\nproperty list uchar int v\nelement vertex 2\nproperty "
        "float x\nproperty list uchar uchar l\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar "
        "green\nproperty uchar blue\nend_header\n");
    for (int i = 0; i < 2; ++i) lists.put(std::uint8_t{1}).put_big_endian(7);
    for (int i = 0; i < 2; ++i)
        lists.put_big_endian(1.f)
            .put(std::uint8_t{2})
            .put(std::uint16_t{0})
            .put_big_endian(2.f)
            .put_big_endian(3.f)
            .put(std::uint8_t{1})
            .put(std::uint16_t{5});
    plain.raw(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double "
        "z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n");
    for (int i = 0; i < 3; ++i) plain.put(1.).put(2.).put(3.).put(1.f).put(0.f).put(0.f);
    return {lists.data, plain.data,
            "ply\nformat ascii 1.0\ncomment x\nelement face 1\nproperty list uchar int v\nelement vertex 3\nproperty "
            "float x\nproperty float y\nproperty float z\nproperty int intensity\nproperty list uchar short "
            "w\nend_header\n3 0 1 2\n1.5 2e3 -3 4 1 7\n1 2 3 4 0\n nan inf -0 5 2 1 2\n"};
}

std::vector<std::string> pcd_seeds()
{
    const auto header = [](const char* encoding) {
        return std::string(
                   "# .PCD v0.7 - Point Cloud Data file format\n# pcm attribute u u16 2 1 0 name -\nVERSION "
                   "0.7\nFIELDS x y z rgb _ u\nSIZE 4 4 8 4 1 2\nTYPE F F F F U U\nCOUNT 1 1 1 1 3 2\nWIDTH "
                   "3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ") +
               encoding + "\n";
    };
    Bytes records, columns;
    for (int i = 0; i < 3; ++i)
        records.put(1.f).put(2.f).put(3.).put(0x00010203u).raw("pad").put(std::uint16_t{7}).put(std::uint16_t{8});
    for (int i = 0; i < 93; ++i) columns.raw(i % 7 ? "a" : "b");
    const std::string packed = lzf_compress(columns.data, 11);
    Bytes block;
    block.put(static_cast<std::uint32_t>(packed.size())).put(93u).raw(packed);
    std::string lines;
    for (int i = 0; i < 3; ++i) lines += "1.5 -2e3 nan 4.2108e+06 0 0 0 7 8\n";
    return {header("ascii") + lines, header("binary") + records.data, header("binary_compressed") + block.data};
}

std::vector<std::string> text_seeds()
{
    return {"1 2 3\n4 5 6\n7 8 9\n", "x,y,z,intensity\r\n1.5,2e3,-3,4\r\n1,,3,9\r\n",
            "//X;Y;Z;R;G;B\n2\n1,5;2;3;4;5;6\n1;2;3;255;0;9\n", "# x y z a_0 a_1\n\n1 2 nan 4 5\n-inf 2 3 4 5\n"};
}

std::vector<std::string> ptx_seeds()
{
    const std::string header = "2\n20\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n";
    std::string plain = header, coloured = header;
    for (int i = 0; i < 20; ++i) {
        plain += "1111.25 2222.5 3333.75 0.5125\n0 0 0 0.5\n";
        coloured += "1111.25 2222.5 3333.75 0.5125 4 5 6\n4444.125 5555.25 6666.5 0.0625 7 8 9\n";
    }
    return {plain, coloured + plain};
}

// Flips, replaces, removes and inserts some bytes, most of them near the start.
std::string mutated(std::string bytes, std::mt19937_64& random)
{
    static constexpr unsigned char favourites[] = {0, 1, 0x7F, 0x80, 0xFF, '\n', ' ', '9', '-'};
    const std::size_t changes = 1 + random() % 6;
    for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
        const std::size_t range = random() % 3 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
        const std::size_t at = random() % range;
        switch (random() % 8) {
            case 0:
            case 1:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
                break;
            case 2:
            case 3:
                bytes[at] = static_cast<char>(favourites[random() % sizeof favourites]);
                break;
            case 4:
                bytes[at] = static_cast<char>(random());
                break;
            case 5:  // a run, so that whole numbers become extreme
                for (std::size_t k = at; k < std::min(bytes.size(), at + 8); ++k)
                    bytes[k] = static_cast<char>(random() % 2 ? 0xFF : bytes[k]);
                break;
            case 6:
                bytes.erase(at, 1 + random() % 20);
                break;
            default:
                bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 20));
                break;
        }
    }
    return bytes;
}

void survive(const std::vector<std::string>& seeds, const char* extension, std::uint64_t seed, int rounds,
             int one_in = 20)
{
    std::mt19937_64 random(seed);
    TemporaryFolder folder;
    int read = 0, refused = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto path = write_file(folder / (std::string("a.") + extension),
                                     mutated(seeds[static_cast<std::size_t>(round) % seeds.size()], random));
        largest_allocation = 0;
        try {
            const auto reader = open_reader(path);
            PointBatch batch;
            std::uint64_t points = 0;
            while (reader->read(batch, 1u << 30)) points += batch.size;
            if (reader->info().points_known) {
                ASSERT_EQ(points, reader->info().points);
            }
            ++read;
        } catch (const Error& error) {
            ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            ++refused;
        }
        // The readers' own buffers are 1 MB.
        ASSERT_LE(largest_allocation.load(), std::size_t{2} << 20) << "round " << round;
    }
    // Otherwise the mutations are too tame or too wild to test anything.
    EXPECT_GT(read, rounds / one_in);
    EXPECT_GT(refused, rounds / one_in);
}

TEST(Mutations, Las) { survive(las_seeds(), "las", 1, 20000); }
TEST(Mutations, Pcd) { survive(pcd_seeds(), "pcd", 3, 20000); }
TEST(Mutations, Text) { survive(text_seeds(), "xyz", 3, 8000); }
TEST(Mutations, Pts)
{
    survive({"3\n1 2 3 4\n5 6 7 8\n9 1 2 3\n", "1\n1 2 3 4 5 6 7\n2\n1 2 3 4 5 6 7\n7 6 5 4 3 2 1\n"}, "pts", 4, 8000,
            30);
}
TEST(Mutations, Ptx) { survive(ptx_seeds(), "ptx", 5, 8000, 50); }
TEST(Mutations, Ply) { survive(ply_seeds(), "ply", 2, 20000); }

}  // namespace
}  // namespace pcm::test
