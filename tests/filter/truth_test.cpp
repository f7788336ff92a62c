// Normals of a generated scan against the primitives that it was made of.
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/generate/scene.h"
#include "tests/filter/oracle.h"
#include "tests/sanitizers.h"

#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;

class Truth : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Noise, Truth, testing::Values(0.0, 0.003));

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(Truth, PCM_NOT_UNDER_THREAD(NormalsAreThoseOfPlanesCylindersAndSpheres))
{
    const TemporaryFolder folder;
    SceneOptions scene;
    scene.points = 150000;
    scene.noise = GetParam();
    scene.scale = 0.0001;
    const SceneReport made = generate_scene(folder / "scene.las", scene);
    build_tree({folder / "scene.las"}, folder / "scene.pct", {});
    NeighbourAttributeOptions options;
    options.wanted = all_values();
    compute_neighbour_attributes(folder / "scene.pct", options);
    std::map<std::uint16_t, const ScenePrimitive*> primitives;
    for (const ScenePrimitive& primitive : made.primitives) primitives[primitive.id] = &primitive;

    std::map<ScenePrimitive::Kind, std::vector<double>> angles;
    const Oracle oracle(folder / "scene.pct");
    for (const OraclePoint& p : oracle.points) {
        const auto found = primitives.find(static_cast<std::uint16_t>(oracle.value(p, "point_source_id")));
        if (found == primitives.end()) continue;
        const ScenePrimitive& primitive = *found->second;
        Vec3d truth = oracle.position(p) - primitive.point;
        if (primitive.kind == ScenePrimitive::Kind::plane) truth = primitive.direction;
        if (primitive.kind == ScenePrimitive::Kind::cylinder)
            truth = truth - dot(truth, primitive.direction) * primitive.direction;
        angles[primitive.kind].push_back(degrees(oracle.normal(p), normalised(truth)));
    }
    ASSERT_EQ(angles.size(), 3u);
    for (auto& [kind, values] : angles) {
        ASSERT_GT(values.size(), 300u);
        std::sort(values.begin(), values.end());
        const double median = values[values.size() / 2];
        // Points at edges have neighbours on other surfaces; pipes are as thin as their points are apart.
        EXPECT_LT(median, kind == ScenePrimitive::Kind::plane ? (GetParam() > 0 ? 0.5 : 0.01) : 3) << int(kind);
    }
}

}  // namespace
