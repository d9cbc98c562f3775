// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mat_file.h"

#include "core/atomic_file.h"

#include <algorithm>
#include <limits>

#include <zlib.h>

namespace dendrofit {
namespace {

enum : std::uint32_t {
  kInt8 = 1,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kSingle,
  kDouble = 9,
  kInt64 = 12,
  kUint64,
  kMatrix,
  kCompressed,
  kUtf8,
  kUtf16,
  kUtf32
};
enum : std::uint32_t {
  kCellClass = 1,
  kStructClass,
  kObjectClass,
  kCharClass,
  kSparseClass,
  kDoubleClass,
  kUint64Class = 15
};

constexpr std::size_t kMostInflated = 256u << 20;  // bytes
constexpr std::size_t kMostNumbers = 40'000'000;
constexpr int kDeepest = 32;

std::size_t width_of(std::uint32_t type) {
  switch (type) {
    case kInt8:
    case kUint8:
    case kUtf8:
      return 1;
    case kInt16:
    case kUint16:
    case kUtf16:
      return 2;
    case kInt32:
    case kUint32:
    case kSingle:
    case kUtf32:
      return 4;
    case kDouble:
    case kInt64:
    case kUint64:
      return 8;
    default:
      return 0;
  }
}

// What all parts of one file share.
struct Budget {
  std::size_t inflated = 0;
  std::size_t numbers = 0;
};

struct Element {
  std::uint32_t type = 0;
  const char* data = nullptr;
  std::size_t bytes = 0;
};

// Walks over the elements of a stretch of bytes, itself in the file (base = its offset) or inflated from
// there.
class Walker {
 public:
  Walker(const std::filesystem::path& path, std::string_view data, std::uint64_t base, bool inflated,
         std::endian order, Budget& budget)
      : path_(path), data_(data), base_(base), inflated_(inflated), order_(order), budget_(budget) {}

  bool at_end() const { return at_ >= data_.size(); }

  Element next() {
    if (data_.size() - at_ < 8) fail("the file ends inside a tag; it is truncated, save or copy it again");
    Element e;
    const auto first = load<std::uint32_t>(data_.data() + at_);
    if (first >> 16) {
      e = {first & 0xffff, data_.data() + at_ + 4, first >> 16};
      if (e.bytes > 4) fail("a small element of " + std::to_string(e.bytes) + " bytes; at most 4 fit");
      at_ += 8;
      return e;
    }
    e = {first, data_.data() + at_ + 8, load<std::uint32_t>(data_.data() + at_ + 4)};
    if (e.bytes > data_.size() - at_ - 8)
      fail("an element of " + std::to_string(e.bytes) + " bytes where " +
           std::to_string(data_.size() - at_ - 8) + " are left; the file is truncated or damaged");
    at_ += 8 + e.bytes;
    if (e.type != kCompressed) at_ = std::min((at_ + 7) & ~std::size_t{7}, data_.size());
    return e;
  }

  [[noreturn]] void fail(const std::string& what) const {
    fail_at_byte(path_, inflated_ ? base_ : base_ + at_,
                 (inflated_ ? "in the compressed variable there: " : "") + what);
  }

  template <class Number>
  Number load(const char* from) const {
    return FileBytes::load<Number>(from, order_);
  }

  // A matrix element's content.
  MatValue matrix(const Element& e, std::string& name, int depth) {
    if (depth > kDeepest) fail("structures nested deeper than 32; the file is damaged");
    MatValue value;
    if (e.bytes == 0) {
      value.kind = MatValue::Kind::numbers;
      value.size = {0, 0};
      return value;
    }
    const auto offset = static_cast<std::uint64_t>(e.data - data_.data());
    Walker in(path_, {e.data, e.bytes}, base_ + (inflated_ ? 0 : offset), inflated_, order_, budget_);
    const Element flags = in.next();
    if (flags.type != kUint32 || flags.bytes != 8) in.fail("no array flags where they should be");
    const std::uint32_t array_class = load<std::uint32_t>(flags.data) & 0xff;
    if (array_class > kUint64Class) return value;  // function handles and objects of classes: nothing for us
    const Element sizes = in.next();
    if (sizes.type != kInt32 || sizes.bytes % 4 || sizes.bytes < 8 || sizes.bytes > 128)
      in.fail("no array size where it should be");
    std::uint64_t count = 1;
    for (std::size_t k = 0; k < sizes.bytes; k += 4) {
      const auto extent = load<std::int32_t>(sizes.data + k);
      if (extent < 0) in.fail("a negative array size");
      value.size.push_back(extent);
      count *= static_cast<std::uint64_t>(extent);
      if (count > (1ULL << 32)) in.fail("an array larger than the file can hold");
    }
    const Element label = in.next();
    if (label.type != kInt8) in.fail("no array name where it should be");
    name.assign(label.data, label.bytes);
    if (array_class == kStructClass)
      in.structure(value, count, depth);
    else if (array_class == kCellClass)
      in.cell(value, count, depth);
    else if (array_class == kCharClass || (array_class >= kDoubleClass && array_class <= kUint64Class))
      in.numeric(value, count, array_class == kCharClass);
    return value;
  }

 private:
  void numeric(MatValue& value, std::uint64_t count, bool text) {
    const Element e = next();
    const std::size_t width = width_of(e.type);
    if (width == 0) fail("numbers of an unknown type " + std::to_string(e.type));
    if (e.bytes / width < count && !(text && e.type == kUtf8))
      fail(std::to_string(count) + " numbers claimed, " + std::to_string(e.bytes / width) + " there");
    count = std::min<std::uint64_t>(count, e.bytes / width);
    budget_.numbers += count;
    if (budget_.numbers > kMostNumbers)
      fail("more than 40 million numbers; save the tree model alone (QSM.cylinder)");
    value.kind = text ? MatValue::Kind::text : MatValue::Kind::numbers;
    value.numbers.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) value.numbers.push_back(one(e.type, e.data + i * width));
  }

  double one(std::uint32_t type, const char* from) const {
    switch (type) {
      case kInt8:
        return load<std::int8_t>(from);
      case kUint8:
      case kUtf8:
        return load<std::uint8_t>(from);
      case kInt16:
        return load<std::int16_t>(from);
      case kUint16:
      case kUtf16:
        return load<std::uint16_t>(from);
      case kInt32:
        return load<std::int32_t>(from);
      case kUint32:
      case kUtf32:
        return load<std::uint32_t>(from);
      case kSingle:
        return static_cast<double>(load<float>(from));
      case kInt64:
        return static_cast<double>(load<std::int64_t>(from));
      case kUint64:
        return static_cast<double>(load<std::uint64_t>(from));
      default:
        return load<double>(from);
    }
  }

  void structure(MatValue& value, std::uint64_t count, int depth) {
    const Element length = next();
    if (length.type != kInt32 || length.bytes < 4) fail("no field name length where it should be");
    const auto width = load<std::int32_t>(length.data);
    const Element names = next();
    if (names.type != kInt8 || width <= 0 || names.bytes % static_cast<std::size_t>(width))
      fail("field names that do not fit their length");
    for (std::size_t at = 0; at < names.bytes; at += static_cast<std::size_t>(width)) {
      const std::string_view field(names.data + at, static_cast<std::size_t>(width));
      value.fields.emplace_back(field.substr(0, field.find('\0')));
    }
    value.kind = MatValue::Kind::structure;
    if (!value.fields.empty()) elements(value, count * value.fields.size(), depth);
  }

  void cell(MatValue& value, std::uint64_t count, int depth) {
    value.kind = MatValue::Kind::cell;
    elements(value, count, depth);
  }

  void elements(MatValue& value, std::uint64_t count, int depth) {
    if (count > (data_.size() - at_) / 8) fail(std::to_string(count) + " elements claimed in too few bytes");
    budget_.numbers += count * (sizeof(MatValue) / sizeof(double));
    if (budget_.numbers > kMostNumbers) fail("too many elements; save the tree model alone (QSM.cylinder)");
    value.elements.reserve(count);
    std::string ignored;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Element e = next();
      if (e.type != kMatrix)
        fail("an element of type " + std::to_string(e.type) + " where an array (14) was expected");
      value.elements.push_back(matrix(e, ignored, depth + 1));
    }
  }

  const std::filesystem::path& path_;
  std::string_view data_;
  std::uint64_t base_;
  bool inflated_;
  std::endian order_;
  Budget& budget_;
  std::size_t at_ = 0;
};

std::string inflate_all(const Walker& walker, const Element& e, Budget& budget) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) walker.fail("decompression could not start");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(e.data));
  stream.avail_in = static_cast<uInt>(e.bytes);
  std::string out;
  int state = Z_OK;
  while (state == Z_OK && budget.inflated + out.size() <= kMostInflated) {
    const std::size_t had = out.size();
    out.resize(had + std::max<std::size_t>(1 << 16, had / 2));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + had);
    stream.avail_out = static_cast<uInt>(out.size() - had);
    state = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
    if (state == Z_OK && stream.avail_in == 0 && stream.avail_out > 0) break;
  }
  inflateEnd(&stream);
  budget.inflated += out.size();
  if (budget.inflated > kMostInflated)
    walker.fail("more than 256 MiB once decompressed; save the tree model alone (QSM.cylinder)");
  if (state != Z_STREAM_END)
    walker.fail("a compressed variable that is damaged or cut off; save or copy the file again");
  return out;
}

}  // namespace

std::size_t MatValue::count() const {
  std::size_t n = 1;
  for (const std::int64_t extent : size) n *= static_cast<std::size_t>(extent);
  return n;
}

const MatValue* MatValue::field(std::string_view name, std::size_t element) const {
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const std::size_t at = element * fields.size() + k;
    if (fields[k] == name && at < elements.size()) return &elements[at];
  }
  return nullptr;
}

std::vector<std::pair<std::string, MatValue>> read_mat(const FileBytes& bytes) {
  const std::string_view view = bytes.view();
  if (view.starts_with("MATLAB 7.3"))
    fail_at_byte(bytes.path(), 0,
                 "a MATLAB 7.3 (HDF5) file; in MATLAB, load it and save it again with the option '-v7'");
  if (!view.starts_with("MATLAB 5.0"))
    fail_at_byte(bytes.path(), 0, shown(view.substr(0, 10)) + " found, 'MATLAB 5.0' expected");
  bytes.need(0, 128, "header");
  const std::string_view mark = view.substr(126, 2);
  if (mark != "IM" && mark != "MI")
    fail_at_byte(bytes.path(), 126, shown(mark) + " found, the byte order mark 'IM' expected");
  const std::endian order = mark == "IM" ? std::endian::little : std::endian::big;
  Budget budget;
  Walker file(bytes.path(), view.substr(128), 128, false, order, budget);
  std::vector<std::pair<std::string, MatValue>> variables;
  while (!file.at_end()) {
    const Element e = file.next();
    std::string name;
    if (e.type == kMatrix) {
      MatValue value = file.matrix(e, name, 0);
      variables.emplace_back(name, std::move(value));
    } else if (e.type == kCompressed) {
      const std::string inflated = inflate_all(file, e, budget);
      Walker inner(bytes.path(), inflated, static_cast<std::uint64_t>(e.data - bytes.data()), true, order,
                   budget);
      const Element matrix = inner.next();
      if (matrix.type != kMatrix)
        inner.fail("type " + std::to_string(matrix.type) + " found, an array (14) expected");
      MatValue value = inner.matrix(matrix, name, 0);
      variables.emplace_back(name, std::move(value));
    } else {
      file.fail("an element of type " + std::to_string(e.type) + " found, an array (14 or 15) expected");
    }
  }
  return variables;
}

namespace {

void append_raw(std::string& out, const void* data, std::size_t bytes) {
  out.append(static_cast<const char*>(data), bytes);
}

void append_u32(std::string& out, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> (8 * k));
}

void append_element(std::string& out, std::uint32_t type, std::string_view data) {
  append_u32(out, type);
  append_u32(out, static_cast<std::uint32_t>(data.size()));
  out += data;
  while (out.size() % 8) out += '\0';
}

std::string array_head(std::uint32_t array_class, std::int64_t rows, std::int64_t columns,
                       const std::string& name) {
  std::string flags;
  append_u32(flags, array_class);
  append_u32(flags, 0);
  std::string sizes;
  append_u32(sizes, static_cast<std::uint32_t>(rows));
  append_u32(sizes, static_cast<std::uint32_t>(columns));
  std::string out;
  append_element(out, kUint32, flags);
  append_element(out, kInt32, sizes);
  append_element(out, kInt8, name);
  return out;
}

std::string structure_of(const std::string& name,
                         const std::vector<std::pair<std::string, std::string>>& fields) {
  constexpr std::size_t width = 32;
  std::string out = array_head(kStructClass, 1, 1, name);
  std::string length;
  append_u32(length, width);
  append_element(out, kInt32, length);
  std::string names;
  for (const auto& [field, matrix] : fields) {
    names += field.substr(0, width - 1);
    names.resize((names.size() / width + 1) * width, '\0');
  }
  append_element(out, kInt8, names);
  for (const auto& [field, matrix] : fields) append_element(out, kMatrix, matrix);
  return out;
}

}  // namespace

void write_mat(const std::filesystem::path& path, const std::string& name, const std::string& inner,
               const std::vector<MatMatrix>& matrices) {
  std::vector<std::pair<std::string, std::string>> fields;
  for (const MatMatrix& m : matrices) {
    const auto columns = m.rows > 0 ? static_cast<std::int64_t>(m.values.size()) / m.rows : 0;
    std::string out = array_head(kDoubleClass, m.rows, columns, "");
    std::string data;
    data.reserve(m.values.size() * 8);
    for (const double value : m.values) {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      for (int k = 0; k < 8; ++k) data += static_cast<char>(bits >> (8 * k));
    }
    append_element(out, kDouble, data);
    fields.emplace_back(m.name, std::move(out));
  }
  std::string text = "MATLAB 5.0 MAT-file, written by dendrofit";
  text.resize(124, ' ');
  const char version[4] = {0x00, 0x01, 'I', 'M'};
  append_raw(text, version, 4);
  append_element(text, kMatrix, structure_of(name, {{inner, structure_of("", fields)}}));
  write_file(path, text);
}

}  // namespace dendrofit
