#include "pcm/system/url.h"

#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

std::string refusal_of(const std::string& address)
{
    try {
        Url::parse(address);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(UrlTest, PathsOfThisMachineAreNone)
{
    for (const char* const path : {"", "a", "/a/b.pct", "a:b", "://a", "1a://b", "C:\\a", "a/b://c", "./http://a"})
        EXPECT_FALSE(is_url(path)) << path;
    for (const char* const path : {"http://a", "HTTPS://a/b.pct", "s3://bucket/a", "ftp://a/b"})
        EXPECT_TRUE(is_url(path)) << path;
}

TEST(UrlTest, ItsParts)
{
    const Url url = Url::parse("HTTPS://Example.org:8443/a b/ä.pct");
    EXPECT_EQ(url.scheme, "https");
    EXPECT_EQ(url.host, "Example.org:8443");
    EXPECT_EQ(url.path, "/a b/ä.pct");
    EXPECT_EQ(url.encoded_path(), "/a%20b/%C3%A4.pct");
    EXPECT_EQ(Url::parse("http://a").path, "/");
    EXPECT_EQ(Url::parse("http://a/b%20c").encoded_path(), "/b%20c");
    EXPECT_EQ(Url::parse("http://[::1]:80/x").host, "[::1]:80");
}

TEST(UrlTest, WhatIsSecretIsRefusedAndNotRepeated)
{
    for (const char* const address :
         {"https://me:secret@host/a.pct", "https://host/a.pct?token=secret", "https://host/a.pct#secret"}) {
        const std::string refusal = refusal_of(address);
        EXPECT_FALSE(refusal.empty()) << address;
        EXPECT_EQ(refusal.find("secret"), std::string::npos) << refusal;
    }
    EXPECT_NE(refusal_of("https://me:secret@host/a.pct").find("password"), std::string::npos);
}

TEST(UrlTest, OtherAddressesAreRefused)
{
    for (const char* const address : {"ftp://a/b", "file:///etc/passwd", "http:///a", "http://a/../b", "http://a/b/..",
                                      "http://a b/c", "http://a\r\nX: y/c", "http://a/b\nc"})
        EXPECT_FALSE(refusal_of(address).empty()) << address;
    EXPECT_TRUE(refusal_of("http://a/b..c/d").empty());
}

TEST(UrlTest, TheTreeOfAnAddress)
{
    for (const char* const path : {"https://a/b/site.pct", "https://a/b/site.pct/", "https://a/b/site.pct/index.pct",
                                   "https://a/b/site.pct/chunks-003.bpc"})
        EXPECT_EQ(tree_folder_of(path), "https://a/b/site.pct");
}

}  // namespace
