// Whether a row of a table can be made without one of its columns: at compile time.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

namespace pcm::rows {

template <class Row, class, class... Columns>
struct IsMadeOf : std::false_type {
};
template <class Row, class... Columns>
struct IsMadeOf<Row, std::void_t<decltype(Row{std::declval<Columns>()...})>, Columns...> : std::true_type {
};

// Whether a row is made of a tuple's columns before `Left` and after it, in their order.
template <class Row, class Columns, std::size_t Left, std::size_t... I>
constexpr bool is_made_without(std::index_sequence<I...>)
{
    return IsMadeOf<Row, void, std::tuple_element_t<(I < Left ? I : I + 1), Columns>...>::value;
}

template <class Row, class Columns, std::size_t... I>
constexpr bool is_made(std::index_sequence<I...>)
{
    return IsMadeOf<Row, void, std::tuple_element_t<I, Columns>...>::value;
}

// The number of columns without which a row still compiles; 0: each is needed.
template <class Row, class Columns, std::size_t... I>
constexpr std::size_t optional_columns(std::index_sequence<I...>)
{
    using Others = std::make_index_sequence<sizeof...(I) - 1>;
    return (0 + ... + std::size_t(is_made_without<Row, Columns, I>(Others{})));
}

template <class Row, class Columns>
struct Table {
    using All = std::make_index_sequence<std::tuple_size_v<Columns>>;
    static constexpr bool is_whole = is_made<Row, Columns>(All{});
    static constexpr std::size_t optional = optional_columns<Row, Columns>(All{});
};

}  // namespace pcm::rows
