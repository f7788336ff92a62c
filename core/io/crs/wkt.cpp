#include "pcm/io/crs/wkt.h"

#include "pcm/io/crs/crs_units.h"
#include "pcm/io/file_text.h"

#include <charconv>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr int deepest = 32;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

// KEYWORD["text",12.5,enumerated,CHILD[...]].
struct Node {
    std::string keyword;              // upper case
    std::vector<std::string> values;  // without quotes
    std::vector<Node> children;

    bool is(std::initializer_list<std::string_view> keywords) const
    {
        for (const std::string_view one : keywords)
            if (keyword == one) return true;
        return false;
    }
    const Node* find(std::initializer_list<std::string_view> keywords) const
    {
        for (const Node& child : children)
            if (child.is(keywords)) return &child;
        return nullptr;
    }
    std::string value(std::size_t i) const { return i < values.size() ? values[i] : std::string(); }
};

class Parser {
public:
    explicit Parser(std::string_view text) : text_(text) {}

    std::optional<Node> parse()
    {
        Node root;
        skip();
        root.keyword = word();
        if (root.keyword.empty() || !body(root, 0)) return {};
        skip();
        if (at_ != text_.size()) return {};
        return root;
    }

private:
    void skip()
    {
        while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    }
    // Letters, digits and signs: a keyword, an enumerated value or a number.
    std::string word()
    {
        std::string found;
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (is_blank(c) || c == '[' || c == ']' || c == '(' || c == ')' || c == ',' || c == '"') break;
            found += upper(c);
        }
        return found;
    }
    bool quoted(std::string& value)
    {
        for (++at_; at_ < text_.size(); ++at_) {
            if (text_[at_] != '"') {
                value += text_[at_];
            } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
                value += text_[at_++];
            } else {
                ++at_;
                return true;
            }
        }
        return false;
    }
    // From the opening bracket to the closing one.
    bool body(Node& node, int depth)
    {
        skip();
        if (depth == deepest || at_ == text_.size() || (text_[at_] != '[' && text_[at_] != '(')) return false;
        do {
            ++at_;  // the bracket or the comma
            skip();
            if (at_ == text_.size()) return false;
            if (text_[at_] == '"') {
                node.values.emplace_back();
                if (!quoted(node.values.back())) return false;
            } else {
                std::string found = word();
                if (found.empty()) return false;
                skip();
                if (at_ < text_.size() && (text_[at_] == '[' || text_[at_] == '(')) {
                    node.children.push_back({std::move(found), {}, {}});
                    if (!body(node.children.back(), depth + 1)) return false;
                } else {
                    node.values.push_back(std::move(found));
                }
            }
            skip();
        } while (at_ < text_.size() && text_[at_] == ',');
        if (at_ == text_.size() || (text_[at_] != ']' && text_[at_] != ')')) return false;
        ++at_;
        return true;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

constexpr auto projected = {"PROJCS", "PROJCRS", "PROJECTEDCRS", "DERIVEDPROJCRS"};
constexpr auto geographic = {"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS"};
constexpr auto geodetic = {"GEODCRS", "GEODETICCRS"};  // geographic or geocentric
constexpr auto vertical = {"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"};
constexpr auto compound = {"COMPD_CS", "COMPOUNDCRS"};
constexpr auto local = {"LOCAL_CS", "ENGCRS", "ENGINEERINGCRS"};

bool is_one_of(const Node& node, const std::initializer_list<const char*>& keywords)
{
    for (const char* one : keywords)
        if (node.keyword == one) return true;
    return false;
}

// Not the locale's strtod: numbers are always written with a point.
double number_of(const std::string& text)
{
    double value = 0;
    const char* from = text.data();
    if (!text.empty() && *from == '+') ++from;
    const auto [end, error] = std::from_chars(from, text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

// The unit of the node itself, else of its axes.
CrsUnit unit_of(const Node& node, bool angular)
{
    const auto read = [&](const Node& unit) {
        const double size = number_of(unit.value(1));
        return angular ? angular_unit(unit.value(0), size) : linear_unit(unit.value(0), size);
    };
    const std::string_view own = angular ? "ANGLEUNIT" : "LENGTHUNIT";
    if (const Node* unit = node.find({own, "UNIT"})) return read(*unit);
    for (const Node& axis : node.children)
        if (axis.keyword == "AXIS")
            if (const Node* unit = axis.find({own, "UNIT"})) return read(*unit);
    return {};
}

CrsPart part_of(const Node& node, bool angular)
{
    CrsPart part;
    part.name = printable_name(node.value(0));
    // AUTHORITY["EPSG","32632"], or ID["EPSG",32632].
    if (const Node* id = node.find({"AUTHORITY", "ID"})) {
        const std::string code = id->value(1);
        unsigned number = 0;
        const auto [end, error] = std::from_chars(code.data(), code.data() + code.size(), number);
        if (error == std::errc() && end == code.data() + code.size()) {
            for (const char c : printable_name(id->value(0))) part.authority += upper(c);
            part.code = number;
        }
    }
    part.unit = unit_of(node, angular);
    return part;
}

// A geographic system of three dimensions has the heights' unit in its third axis.
CrsPart ellipsoidal_heights(const Node& node)
{
    CrsPart part;
    for (const Node& axis : node.children)
        if (axis.keyword == "AXIS")
            if (const Node* unit = axis.find({"LENGTHUNIT"})) {
                part.name = "ellipsoidal height";
                part.unit = linear_unit(unit->value(0), number_of(unit->value(1)));
            }
    return part;
}

bool add(const Node& node, CoordinateSystem& to)
{
    if (is_one_of(node, compound)) {
        bool any = false;
        for (const Node& child : node.children) any = add(child, to) || any;
        if (any) to.name = printable_name(node.value(0));
        return any;
    }
    if (node.keyword == "BOUNDCRS") {
        const Node* source = node.find({"SOURCECRS"});
        return source && !source->children.empty() && add(source->children[0], to);
    }
    if (is_one_of(node, vertical)) {
        to.vertical = part_of(node, false);
        return true;
    }
    const Node* axes = node.find({"CS"});
    const bool cartesian = axes && axes->value(0) == "CARTESIAN";
    if (is_one_of(node, projected))
        to.kind = CrsKind::projected;
    else if (node.keyword == "GEOCCS" || (is_one_of(node, geodetic) && cartesian))
        to.kind = CrsKind::geocentric;
    else if (is_one_of(node, geographic) || is_one_of(node, geodetic))
        to.kind = CrsKind::geographic;
    else if (is_one_of(node, local))
        to.kind = CrsKind::local;
    else
        return false;
    to.horizontal = part_of(node, to.kind == CrsKind::geographic);
    if (to.kind == CrsKind::geographic) to.vertical = ellipsoidal_heights(node);
    if (to.name.empty()) to.name = to.horizontal.name;
    return true;
}

}  // namespace

std::optional<CoordinateSystem> decode_wkt(std::string_view text)
{
    text = text.substr(0, text.find('\0'));
    const std::optional<Node> root = Parser(text).parse();
    CoordinateSystem system;
    if (!root || !add(*root, system)) return {};
    if (system.name.empty()) system.name = printable_name(root->value(0));
    system.source = "WKT";
    system.wkt = text;
    return system;
}

std::string compact_wkt(std::string_view text)
{
    std::string compact;
    bool inside = false;
    for (const char c : text.substr(0, text.find('\0'))) {
        if (c == '"') inside = !inside;
        if (inside)
            compact += c;
        else if (!is_blank(c))
            compact += c == '(' ? '[' : c == ')' ? ']' : upper(c);
    }
    return compact;
}

}  // namespace pcm
