// Words behind options: which are accepted, and the messages for the others.

#include "pcm/ops/values.h"

#include <gtest/gtest.h>

#include <limits>

namespace pcm::ops {
namespace {

TEST(OptionValues, NumbersSayWhatIsAllowedInShortForm)
{
    const AllowedNumbers above{0.0, std::nullopt, true}, not_below{0.0, std::nullopt}, between{0.5, 1e6};
    const AllowedNumbers whole{1.0, 8.0, false, true};
    EXPECT_EQ(number_fault("abc", above), "'abc' is not a number greater than 0");
    EXPECT_EQ(number_fault("0", above), "'0' is not a number greater than 0");
    EXPECT_EQ(number_fault("-1e-9", not_below), "'-1e-9' is not a number that is 0 or more");
    EXPECT_EQ(number_fault("0.4", between), "'0.4' is not a number from 0.5 to 1000000");
    EXPECT_EQ(number_fault("2.5", whole), "'2.5' is not a whole number from 1 to 8");
    EXPECT_EQ(number_fault("9", whole), "'9' is not a whole number from 1 to 8");
    EXPECT_EQ(number_fault("", {}), "'' is not a number");
    EXPECT_EQ(number_fault("1 ", {}), "'1 ' is not a number");
    EXPECT_EQ(number_fault("0x10", {}), "'0x10' is not a number");
    EXPECT_EQ(number_fault("1e400", {}), "'1e400' is too large or too small a number");
    EXPECT_EQ(number_fault("nan", above), "'nan' is not a number greater than 0");
    EXPECT_EQ(number_fault("inf", above), "'inf' is not a number greater than 0");
    for (const char* good : {"1", "+1", "1e-9", "1.5", ".5", "5."}) EXPECT_EQ(number_fault(good, above), "") << good;
    EXPECT_EQ(number_fault("0", not_below), "");
    EXPECT_EQ(number_fault("0.5", between) + number_fault("1e6", between) + number_fault("8", whole), "");
    EXPECT_EQ(brief_text_of(whole), "1 to 8");
    EXPECT_EQ(brief_text_of(above), "above 0");
}

TEST(OptionValues, WholeNumbersAreDecimal)
{
    const auto read = [](std::string word, std::uint64_t most = 65535) {
        const std::string fault = whole_fault(word, most);
        return fault.empty() ? word : fault;
    };
    EXPECT_EQ(read("7"), "7");
    EXPECT_EQ(read("+7"), "7");
    EXPECT_EQ(read("010"), "10");  // never octal
    EXPECT_EQ(read("1e3"), "1000");
    EXPECT_EQ(read("65535"), "65535");
    EXPECT_EQ(read("65536"), "'65536' is too large; 65535 is the largest");
    EXPECT_EQ(read("99999999999999999999", ~std::uint64_t(0)).substr(0, 35), "'99999999999999999999' is too large");
    EXPECT_EQ(read("1e30"), "'1e30' is too large; 65535 is the largest");
    EXPECT_EQ(read("18446744073709551615", std::numeric_limits<std::uint64_t>::max()), "18446744073709551615");
    EXPECT_EQ(read("-1"), "'-1' is not a whole number, 0 or more");
    for (const char* bad : {"", "1.5", "abc", "0x10", "7 ", "1,000", "nan"})
        EXPECT_EQ(read(bad), "'" + std::string(bad) + "' is not a whole number") << bad;
}

TEST(OptionValues, SizesHaveUnits)
{
    const auto read = [](std::string word) { return bytes_fault(word).empty() ? word : ""; };
    EXPECT_EQ(read("512"), "512");
    EXPECT_EQ(read("2K"), "2048");
    EXPECT_EQ(read("2k"), "2048");
    EXPECT_EQ(read("2 KiB"), "2048");
    EXPECT_EQ(read("2kb"), "2048");
    EXPECT_EQ(read("1.5M"), "1572864");
    EXPECT_EQ(read("3G"), "3221225472");
    EXPECT_EQ(read("7B"), "7");
    for (const char* bad : {"", "M", "2Q", "-1M", "1.2.3M", "2KK", "1e3K", "99999999999T", "2 X", "nanM"})
        EXPECT_EQ(read(bad), "") << bad;
    std::string word = "2Q";
    EXPECT_NE(bytes_fault(word).find("as in 512M"), std::string::npos);
}

TEST(OptionValues, ChoicesSayWhatWasMeant)
{
    EXPECT_EQ(choice_fault("even", {"fast", "even"}), "");
    EXPECT_EQ(choice_fault("evn", {"fast", "even"}), "'evn' is not fast or even; perhaps even");
    EXPECT_EQ(choice_fault("q", {"a1", "b2", "c3"}), "'q' is not a1, b2 or c3");
}

}  // namespace
}  // namespace pcm::ops
