#include "tests/gl/gl_support.h"

#include "pcm/gl/base/shader_program.h"
#include "pcm/gl/draw/splat_program.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

using namespace pcm;
using namespace pcm::test;

namespace {

// Permutations of every splat mode; colourings, which do not interact with the rest, take turns.
std::vector<SplatPermutation> permutations()
{
    std::vector<SplatPermutation> list;
    for (const SplatTraits& mode : splat_modes()) {
        const bool disc = mode.shape == SplatShape::disc;
        for (const bool quads : {false, true})
            for (const bool orthographic : {false, true})
                for (const unsigned samples : {1u, 8u})
                    for (const bool doubles : {false, true}) {
                        const bool used = (!quads || mode.shape != SplatShape::pixels) &&
                                          (!orthographic || (disc && mode.in_parallel == mode.mode)) &&
                                          (samples == 1 || disc) && (!doubles || mode.has_doubles);
                        if (used)
                            list.push_back({mode.mode, static_cast<Colouring>(list.size() % 3), orthographic, quads,
                                            samples, doubles});
                    }
    }
    return list;
}

}  // namespace

TEST(ShaderProgram, BuildsEveryPermutationInBothProfiles)
{
    for (const Profile profile : {Profile::compatibility, Profile::core}) {
        PCM_REQUIRE_GL(context, profile);
        for (const SplatPermutation& permutation : permutations()) {
            ShaderProgram program("splat.vert", "splat.frag", permutation.defines());
            EXPECT_TRUE(program);
            EXPECT_GE(program.uniform("projection"), 0);
            program.release();
            EXPECT_FALSE(program);
        }
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    }
}

TEST(ShaderProgram, AnErrorNamesFilePermutationAndTheDriversReason)
{
    PCM_REQUIRE_GL(context, Profile::core);
    try {
        // A permutation that breaks the source: `position` becomes a keyword.
        ShaderProgram program("splat.vert", "splat.frag", {"VERTEX_COLOUR", "position while"});
        FAIL() << "compiled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        const std::string text = error.what();
        EXPECT_NE(text.find("splat.vert"), std::string::npos) << text;
        EXPECT_NE(text.find("position while"), std::string::npos) << text;
        // And the line of the file where it stands.
        std::string_view source;
        for (const ShaderSource& file : shader_sources())
            if (file.file == "splat.vert") source = file.text;
        const std::string_view before = source.substr(0, source.find("in vec3 position;"));
        EXPECT_NE(text.find(std::to_string(std::count(before.begin(), before.end(), '\n') + 1)), std::string::npos)
            << text;
    }
    try {
        ShaderProgram program("teapot.vert", "splat.frag");
        FAIL() << "compiled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found);
    }
}
