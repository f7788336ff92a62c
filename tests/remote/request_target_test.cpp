#include "pcm/remote/request_target.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr const char* variables[] = {
    "AWS_ENDPOINT_URL_S3",   "AWS_ENDPOINT_URL",  "AWS_REGION",  "AWS_DEFAULT_REGION", "AWS_ACCESS_KEY_ID",
    "AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN", "AWS_PROFILE", "AWS_CONFIG_FILE",    "AWS_SHARED_CREDENTIALS_FILE"};

// An environment without settings of S3, but for what a test gives it.
class RequestTargetTest : public testing::Test {
protected:
    RequestTargetTest()
    {
        for (const char* const name : variables) unsetenv(name);
        set("HOME", folder_.path().string());
    }
    ~RequestTargetTest() override
    {
        for (const char* const name : variables) unsetenv(name);
        if (home_.empty())
            unsetenv("HOME");
        else
            set("HOME", home_);
    }
    static void set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }
    static RequestTarget target(const std::string& address) { return target_of(Url::parse(address)); }
    void write(const std::string& name, const std::string& text) const
    {
        std::filesystem::create_directories(folder_ / ".aws");
        std::ofstream(folder_ / (".aws/" + name)) << text;
    }

    const std::string home_ = getenv("HOME") ? getenv("HOME") : "";
    TemporaryFolder folder_;
};

TEST_F(RequestTargetTest, OtherAddressesStayAsTheyAreAndAreNeverSigned)
{
    set("AWS_ACCESS_KEY_ID", "key");
    set("AWS_SECRET_ACCESS_KEY", "secret");
    const RequestTarget plain = target("https://host:8/a b.pct");
    EXPECT_EQ(plain.url, "https://host:8/a%20b.pct");
    EXPECT_FALSE(plain.credentials);
}

TEST_F(RequestTargetTest, ABucketWithoutKeysIsAPublicOne)
{
    const RequestTarget bucket = target("s3://scans/2026/site.pct/index.pct");
    EXPECT_EQ(bucket.url, "https://scans.s3.us-east-1.amazonaws.com/2026/site.pct/index.pct");
    EXPECT_EQ(bucket.region, "us-east-1");
    EXPECT_FALSE(bucket.credentials);
}

TEST_F(RequestTargetTest, TheEnvironmentNamesServerRegionAndKeys)
{
    set("AWS_DEFAULT_REGION", "eu-west-1");
    EXPECT_EQ(target("s3://b/x").region, "eu-west-1");
    set("AWS_REGION", "eu-central-1");
    EXPECT_EQ(target("s3://b/x").url, "https://b.s3.eu-central-1.amazonaws.com/x");
    set("AWS_ENDPOINT_URL", "http://127.0.0.1:9000/");
    EXPECT_EQ(target("s3://b/x").url, "http://127.0.0.1:9000/b/x");
    set("AWS_ENDPOINT_URL_S3", "https://store.example/root");
    EXPECT_EQ(target("s3://b/x").url, "https://store.example/root/b/x");
    set("AWS_ACCESS_KEY_ID", "key");
    set("AWS_SECRET_ACCESS_KEY", "secret");
    set("AWS_SESSION_TOKEN", "token");
    const auto keys = target("s3://b/x").credentials;
    ASSERT_TRUE(keys);
    EXPECT_EQ(keys->key_id + " " + keys->secret + " " + keys->session_token, "key secret token");
}

TEST_F(RequestTargetTest, FilesNameThemByProfile)
{
    write("credentials",
          "# keys\n[default]\naws_access_key_id = one\naws_secret_access_key=two\n\n[work]\n"
          "aws_access_key_id=three\r\naws_secret_access_key = four = 4\n");
    write("config",
          "[default]\nregion = eu-north-1\n[profile work]\nregion=eu-south-1\nendpoint_url = http://store:1\n");
    EXPECT_EQ(target("s3://b/x").credentials.value().key_id, "one");
    EXPECT_EQ(target("s3://b/x").region, "eu-north-1");
    set("AWS_PROFILE", "work");
    EXPECT_EQ(target("s3://b/x").credentials.value().key_id, "three");
    EXPECT_EQ(target("s3://b/x").credentials.value().secret, "four = 4");
    EXPECT_EQ(target("s3://b/x").url, "http://store:1/b/x");
    set("AWS_ACCESS_KEY_ID", "mine");
    set("AWS_SECRET_ACCESS_KEY", "own");
    EXPECT_EQ(target("s3://b/x").credentials.value().key_id, "mine");
}

TEST_F(RequestTargetTest, HalfOfAPairOfKeysIsRefusedWithoutRepeatingIt)
{
    set("AWS_SECRET_ACCESS_KEY", "hidden");
    try {
        target("s3://b/x");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_EQ(std::string(error.what()).find("hidden"), std::string::npos);
    }
    set("AWS_ACCESS_KEY_ID", "key");
    EXPECT_NO_THROW(target("s3://b/x"));
    set("AWS_ENDPOINT_URL", "store:9000");
    EXPECT_THROW(target("s3://b/x"), Error);
}

}  // namespace
