// Lists with undo against a naive model that keeps every state.
#include "pcm/lists/undo_list.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;

struct Thing {
    std::string name;
    bool hidden = false;
    int value = 0;
    bool operator==(const Thing& o) const { return name == o.name && hidden == o.hidden && value == o.value; }
};

class Things : public UndoList<Thing> {
public:
    Things() : UndoList("thing") {}
    void add(const std::vector<Thing>& added) { append(added); }
    bool named(const std::string& name) const { return has_name(name); }
    void forget() { forget_steps(); }
};

using State = std::vector<Thing>;

State state_of(const Things& list)
{
    State state;
    for (std::size_t i = 0; i < list.size(); ++i) {
        EXPECT_TRUE(list[i] == list.at(i));
        state.push_back(list[i]);
    }
    EXPECT_EQ(list.empty(), state.empty());
    return state;
}

std::string refusal(const std::function<void()>& call)
{
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(UndoList, IsAsAModelThatKeepsEveryState)
{
    std::mt19937 random(1);
    Things list;
    State now;
    std::deque<State> before;
    std::vector<State> after;
    const auto changed = [&](const State& next) {
        before.push_back(now);
        if (before.size() > 1000) before.pop_front();
        after.clear();
        now = next;
    };
    for (int round = 0; round < 20000; ++round) {
        State next = now;
        const std::size_t index = now.empty() ? 0 : random() % now.size();
        const Thing thing{"name " + std::to_string(random() % 30), random() % 2 == 0, round};
        switch (random() % 9) {
            case 0:
                for (std::size_t n = random() % 3; n > 0; --n) next.push_back({thing.name, thing.hidden, round});
                list.add({next.begin() + static_cast<std::ptrdiff_t>(now.size()), next.end()});
                changed(next);
                break;
            case 1:
                if (now.empty()) break;
                next[index] = thing;
                list.replace(index, thing);
                changed(next);
                break;
            case 2:
                if (now.empty()) break;
                next[index].name = thing.name;
                list.rename(index, thing.name);
                changed(next);
                break;
            case 3:
                if (now.empty()) break;
                next[index].hidden = thing.hidden;
                list.hide(index, thing.hidden);
                changed(next);
                break;
            case 4:
                if (now.empty()) break;
                next.erase(next.begin() + static_cast<std::ptrdiff_t>(index));
                list.remove(index);
                changed(next);
                break;
            case 5:
                if (random() % 20) break;
                list.clear();
                if (!now.empty()) changed({});
                break;
            case 6:
            case 7:
                list.undo();
                if (before.empty()) break;
                after.push_back(now);
                now = before.back();
                before.pop_back();
                break;
            default:
                list.redo();
                if (after.empty()) break;
                before.push_back(now);
                now = after.back();
                after.pop_back();
        }
        ASSERT_TRUE(state_of(list) == now) << round;
        ASSERT_EQ(list.can_undo(), !before.empty());
        ASSERT_EQ(list.can_redo(), !after.empty());
        ASSERT_EQ(list.named(thing.name),
                  std::any_of(now.begin(), now.end(), [&](const Thing& t) { return t.name == thing.name; }));
    }
    list.undo();
    list.forget();
    EXPECT_FALSE(list.can_undo());
    EXPECT_FALSE(list.can_redo());
}

TEST(UndoList, WhatIsRefusedChangesNothing)
{
    Things list;
    EXPECT_EQ(refusal([&] { list.remove(0); }), "there is no thing number 1; the list has 0");
    list.add({{"a"}, {"b"}});
    const State before = state_of(list);
    EXPECT_EQ(refusal([&] { list.at(2); }), "there is no thing number 3; the list has 2");
    EXPECT_EQ(refusal([&] { list.rename(2, "c"); }), "there is no thing number 3; the list has 2");
    EXPECT_EQ(refusal([&] { list.hide(7, true); }), "there is no thing number 8; the list has 2");
    EXPECT_EQ(refusal([&] { list.replace(2, {"c"}); }), "there is no thing number 3; the list has 2");
    EXPECT_EQ(refusal([&] { list.remove(2); }), "there is no thing number 3; the list has 2");
    EXPECT_EQ(refusal([&] { list.rename(0, ""); }), "the name of a thing is empty");
    EXPECT_EQ(refusal([&] { list.replace(0, {""}); }), "the name of a thing is empty");
    EXPECT_EQ(refusal([&] { list.add({{"c"}, {"d\n"}}); }), "the name of a thing has control characters");
    EXPECT_TRUE(state_of(list) == before);
    list.undo();
    EXPECT_TRUE(list.empty()) << "one step, both";
    EXPECT_FALSE(list.can_undo());
}

}  // namespace
