// Fits in a cloud of several stations as a user meets them: files of scans, what is printed, and what is given.

#include "tests/cli/command.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <cmath>
#include <fstream>
#include <iomanip>

namespace {

using namespace pcm::test;
using ::pcm::Vec3d;

constexpr double pipe_radius = 0.2, scan_noise = 0.001;
constexpr Vec3d hall{454321, 5412345, 310};

class StationsCommand : public CommandTest {
protected:
    // A scan of a pipe and the floor from one side, whose registration leaves it shifted.
    void write_scan(const std::string& name, double from, const Vec3d& shift, bool poses = true)
    {
        Dice dice(static_cast<std::uint64_t>(from * 10));
        std::ofstream file(folder_ / name);
        file << std::setprecision(9);
        constexpr int count = 9000;
        if (poses)
            file << "1\n"
                 << count << "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                 << hall[0] + shift[0] << ' ' << hall[1] + shift[1] << ' ' << hall[2] + shift[2] << " 1\n";
        for (int i = 0; i < count; ++i) {
            const double a = from + dice.between(0, 3.4), r = pipe_radius + scan_noise * dice.normal();
            Vec3d p{2 + r * std::cos(a), r * std::sin(a), dice.between(0.5, 1.5)};
            if (i % 3 == 0) p = {dice.between(1, 3), dice.between(-1, 1), scan_noise * dice.normal()};
            if (i % 3 == 1) p = {3.5 + scan_noise * dice.normal(), dice.between(-1, 1), dice.between(0, 2)};
            if (i % 12 == 1) p = {dice.between(1, 3), 1.5 + scan_noise * dice.normal(), dice.between(0, 2)};
            for (std::size_t k = 0; k < 3 && !poses; ++k) p[k] += hall[k];
            file << p[0] << ' ' << p[1] << ' ' << p[2] << (poses ? " 0.5\n" : "\n");
        }
    }
    Json fit(const std::string& tree, const std::string& more = "")
    {
        const Result result =
            pcmlab("fit --json " + path(tree) + " --at 454323.2 5412345 311 --shape cylinder " + more);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
};

TEST_F(StationsCommand, ScansOfSeveralFilesAreStations)
{
    write_scan("a.ptx", 0, {0.002, 0, 0.001});
    write_scan("b.ptx", 2.8, {-0.002, 0.001, -0.001});
    ASSERT_EQ(pcmlab("build -q " + path("a.ptx") + " " + path("b.ptx") + " -o " + path("two.pct")).code, 0);
    const Json json = fit("two.pct", "--add " + path("list.json"));
    const Json& primitive = json["primitive"];
    ASSERT_EQ(primitive["verdict"], "good") << primitive;
    const Json& stations = primitive["stations"];
    EXPECT_EQ(stations["source"], "attribute");
    EXPECT_EQ(stations["count"], 2);
    EXPECT_GT(stations["spread"], 0.0007);
    EXPECT_LT(stations["spread"], 0.005);
    EXPECT_GE(stations["freedom"], 2);
    EXPECT_EQ(json["sigma_contains"], Json::parse(R"(["noise", "stations"])"));
    EXPECT_LT(std::fabs(primitive["radius"].get<double>() - pipe_radius),
              3 * primitive["sigma"]["radius"].get<double>());
    EXPECT_GT(primitive["sigma"]["radius"], 0.0003);
    const Result text = pcmlab("fit " + path("two.pct") + " --at 454323.2 5412345 311 --shape cylinder");
    EXPECT_NE(text.out.find("seen from 2 stations; stations differ by 0.00"), std::string::npos) << text.out;
    // The list keeps it.
    const Result list = pcmlab("primitives --json " + path("list.json"));
    ASSERT_EQ(list.code, 0) << list.err;
    std::ifstream file(folder_ / "list.json");
    EXPECT_EQ(Json::parse(file)["primitives"][0]["stations"], stations);
    // What is given counts where it is larger.
    const Json given = fit("two.pct", "--registration 50");
    EXPECT_EQ(given["sigma_contains"], Json::parse(R"(["noise", "registration"])"));
    EXPECT_GT(given["primitive"]["sigma"]["position"], 0.02);
    // A scan alone has no attribute, and says nothing.
    ASSERT_EQ(pcmlab("build -q " + path("a.ptx") + " -o " + path("one.pct")).code, 0);
    EXPECT_EQ(fit("one.pct")["primitive"]["stations"]["source"], "none");
}

// The scanner of each scan stands at its own place: normals of both point there.
TEST_F(StationsCommand, NormalsPointToTheScannerOfTheirScan)
{
    // Two walls, each seen from between them: the scanners stand at x = 10 and x = 30.
    for (const auto& [name, x] : {std::pair{"a.ptx", 10}, {"b.ptx", 30}}) {
        std::ofstream file(folder_ / name);
        file << "1\n800\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" << x << " 0 0 1\n";
        for (int i = 0; i < 800; ++i)
            file << (x == 10 ? 5 : -5) << ' ' << i % 40 * 0.1 << ' ' << i / 40 * 0.1 << " 1\n";
    }
    ASSERT_EQ(pcmlab("build -q " + path("a.ptx") + " " + path("b.ptx") + " -o " + path("walls.pct")).code, 0);
    const Result result = pcmlab("normals -q " + path("walls.pct") + " --scanners -o " + path("out.pct"));
    ASSERT_EQ(result.code, 0) << result.err;
    const auto points = [&](const std::string& where) {
        const Result found = pcmlab("select --json " + path("out.pct") + " --where scan=" + where);
        return found.code == 0 ? Json::parse(found.out)["points"].get<int>() : -1;
    };
    EXPECT_EQ(points("1 --where 'normal[0]<-0.9'"), 800);
    EXPECT_EQ(points("2 --where 'normal[0]>0.9'"), 800);
    EXPECT_NE(pcmlab("normals -q " + path("walls.pct") + " --scanners --direction 0 0 1 -o " + path("x.pct")).code, 0);
    write_scan("c.xyz", 0, {}, false);
    ASSERT_EQ(pcmlab("build -q " + path("c.xyz")).code, 0);
    const Result none = pcmlab("normals -q " + path("c.pct") + " --scanners -o " + path("x.pct"));
    EXPECT_NE(none.code, 0);
    EXPECT_NE(none.err.find("does not say where its scanner stood"), std::string::npos) << none.err;
}

TEST_F(StationsCommand, WhatIsGivenIsAddedInMillimetres)
{
    write_scan("a.xyz", 0, {}, false);
    ASSERT_EQ(pcmlab("build -q " + path("a.xyz") + " -o " + path("a.pct")).code, 0);
    const Json points = fit("a.pct")["primitive"], given = fit("a.pct", "--registration 1.5")["primitive"];
    EXPECT_EQ(given["stations"]["registration"], 0.0015);
    for (const char* number : {"position", "radius"})
        EXPECT_NEAR(given["sigma"][number].get<double>(), std::hypot(points["sigma"][number].get<double>(), 0.0015),
                    1e-9);
    EXPECT_EQ(fit("a.pct")["sigma_contains"], Json::parse(R"(["noise", "rays"])"));
    const Result text =
        pcmlab("fit " + path("a.pct") + " --at 454323.2 5412345 311 --shape cylinder --registration 1.5");
    EXPECT_NE(text.out.find("a registration within 0.0015 as given"), std::string::npos) << text.out;
    EXPECT_EQ(pcmlab("fit " + path("a.pct") + " --at 454323.2 5412345 311 --registration -1").code, 2);
    const Result help = pcmlab("fit --help");
    EXPECT_NE(help.out.find("--registration"), std::string::npos);
    EXPECT_NE(help.out.find("the +- contains the noise of the points alone"), std::string::npos) << help.out;
}

}  // namespace
