#include "tests/gl/gl_support.h"

#include "pcm/gl/shader_program.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <string>
#include <string_view>

using namespace pcm;
using namespace pcm::test;

TEST(ShaderProgram, BuildsEveryPermutationInBothProfiles)
{
    for (const Profile profile : {Profile::compatibility, Profile::core}) {
        PCM_REQUIRE_GL(context, profile);
        for (const std::vector<std::string>& defines :
             std::vector<std::vector<std::string>>{{},
                                                   {"VERTEX_COLOUR"},
                                                   {"HEIGHT_COLOUR"},
                                                   {"DYNAMIC"},
                                                   {"DYNAMIC", "QUADS", "VERTEX_COLOUR"},
                                                   {"AFFINE"},
                                                   {"AFFINE", "QUADS", "SAMPLES 4"},
                                                   {"DISC", "HEIGHT_COLOUR"},
                                                   {"DISC", "DOUBLE", "QUADS"},
                                                   {"DISC", "ORTHOGRAPHIC", "SAMPLES 8"},
                                                   {"DISC", "ORTHOGRAPHIC", "DOUBLE", "VERTEX_COLOUR"}}) {
            ShaderProgram program("splat.vert", "splat.frag", defines);
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
