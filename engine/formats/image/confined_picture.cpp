#include "engine/formats/image/confined_picture.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/bytes.h"
#include "engine/base/confined.h"
#include "engine/base/input_error.h"

namespace lensproof::formats {

namespace {

namespace fs = std::filesystem;

// A spec's own XML would round its numbers. What a confined process sends may be anything: `Taker` checks all lengths,
// and the spec's numbers are those that any file may state.

void put_text(std::string& bytes, std::string_view text) {
    append_bytes(bytes, text.size());
    bytes.append(text);
}

void put_type(std::string& bytes, const OIIO::TypeDesc& type) {
    append_bytes(bytes, type.basetype, type.aggregate, type.vecsemantics, type.arraylen);
}

class Taker {
  public:
    Taker(const fs::path& file, std::string_view bytes) : file_(&file), rest_(bytes) {}

    template <class Number>
    Number number() {
        const std::optional<Number> taken = take_bytes<Number>(rest_);
        return taken ? *taken : fail<Number>();
    }

    std::string_view text() {
        const auto size = number<std::size_t>();
        if (size > rest_.size()) {
            fail<int>();
        }
        const std::string_view taken = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return taken;
    }

    OIIO::TypeDesc type() {
        OIIO::TypeDesc type;
        type.basetype = number<unsigned char>();
        type.aggregate = number<unsigned char>();
        type.vecsemantics = number<unsigned char>();
        type.arraylen = static_cast<int>(count<int>());
        if (type.basetype >= OIIO::TypeDesc::LASTBASE || type.aggregate < 1 || type.aggregate > 16) {
            fail<int>();
        }
        return type;
    }

    /// A count of things of which each takes a byte at least.
    template <class Number = std::size_t>
    std::size_t count() {
        const auto taken = static_cast<std::size_t>(number<Number>());
        return taken <= rest_.size() ? taken : fail<std::size_t>();
    }

    template <class Any>
    [[noreturn]] Any fail() const {
        throw InputError(file_->string() + ": its reader's answer makes no sense, as if the file had taken it over");
    }

  private:
    const fs::path* file_;
    std::string_view rest_;
};

/// The sizes of a spec, in the order in which they are sent.
constexpr std::array kSizes = {&OIIO::ImageSpec::x,
                               &OIIO::ImageSpec::y,
                               &OIIO::ImageSpec::z,
                               &OIIO::ImageSpec::width,
                               &OIIO::ImageSpec::height,
                               &OIIO::ImageSpec::depth,
                               &OIIO::ImageSpec::full_x,
                               &OIIO::ImageSpec::full_y,
                               &OIIO::ImageSpec::full_z,
                               &OIIO::ImageSpec::full_width,
                               &OIIO::ImageSpec::full_height,
                               &OIIO::ImageSpec::full_depth,
                               &OIIO::ImageSpec::tile_width,
                               &OIIO::ImageSpec::tile_height,
                               &OIIO::ImageSpec::tile_depth,
                               &OIIO::ImageSpec::nchannels,
                               &OIIO::ImageSpec::alpha_channel,
                               &OIIO::ImageSpec::z_channel};

void put_spec(std::string& bytes, const OIIO::ImageSpec& spec) {
    for (const auto size : kSizes) {
        append_bytes(bytes, spec.*size);
    }
    append_bytes(bytes, spec.deep);
    put_type(bytes, spec.format);
    append_bytes(bytes, spec.channelformats.size());
    for (const OIIO::TypeDesc& format : spec.channelformats) {
        put_type(bytes, format);
    }
    append_bytes(bytes, spec.channelnames.size());
    for (const std::string& name : spec.channelnames) {
        put_text(bytes, name);
    }
    append_bytes(bytes, spec.extra_attribs.size());
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        put_text(bytes, attribute.name().string());
        put_type(bytes, attribute.type());
        append_bytes(bytes, attribute.nvalues());
        const std::size_t count = attribute.type().basevalues() * static_cast<std::size_t>(attribute.nvalues());
        if (attribute.type().basetype == OIIO::TypeDesc::STRING) {
            for (std::size_t i = 0; i < count; ++i) {
                put_text(bytes, attribute.get_string_indexed(static_cast<int>(i)));
            }
        } else {
            put_text(bytes,
                     {static_cast<const char*>(attribute.data()), static_cast<std::size_t>(attribute.datasize())});
        }
    }
}

void take_attribute(OIIO::ImageSpec& spec, Taker& taker) {
    const OIIO::ustring name{std::string(taker.text())};
    const OIIO::TypeDesc type = taker.type();
    const std::size_t values = taker.count<int>();
    const std::size_t count = type.basevalues() * values;
    if (type.basetype == OIIO::TypeDesc::PTR) {
        taker.fail<int>();
    }
    if (type.basetype == OIIO::TypeDesc::STRING) {
        std::vector<OIIO::ustring> texts;
        for (std::size_t i = 0; i < count; ++i) {
            texts.emplace_back(std::string(taker.text()));
        }
        spec.extra_attribs.emplace_back(name, type, static_cast<int>(values), texts.data());
    } else {
        const std::string_view data = taker.text();
        if (data.size() != type.basesize() * count) {
            taker.fail<int>();
        }
        spec.extra_attribs.emplace_back(name, type, static_cast<int>(values), data.data());
    }
}

OIIO::ImageSpec take_spec(Taker& taker) {
    OIIO::ImageSpec spec;
    for (const auto size : kSizes) {
        spec.*size = taker.number<int>();
    }
    spec.deep = taker.number<bool>();
    spec.format = taker.type();
    for (std::size_t i = taker.count(); i > 0; --i) {
        spec.channelformats.push_back(taker.type());
    }
    for (std::size_t i = taker.count(); i > 0; --i) {
        spec.channelnames.emplace_back(taker.text());
    }
    for (std::size_t i = taker.count(); i > 0; --i) {
        take_attribute(spec, taker);
    }
    // What a reader's own spec holds to, and the library's code relies on.
    const auto channels = static_cast<std::size_t>(std::max(0, spec.nchannels));
    if (spec.nchannels < 0 || spec.channelnames.size() != channels ||
        (!spec.channelformats.empty() && spec.channelformats.size() != channels)) {
        taker.fail<int>();
    }
    return spec;
}

/// What the asker wants: another part of the file, or rows of the part that it is at.
enum class Wish : char { part, rows };

/// Answers an asker's wishes from the picture that is open here.
class Decoder {
  public:
    Decoder(const fs::path& file, OIIO::ImageInput& input) : file_(&file), input_(&input) {}

    void answer(std::string_view request, MessageChannel& channel) {
        Taker taker(*file_, request);
        if (taker.number<char>() == static_cast<char>(Wish::part)) {
            answer_part(taker.number<int>(), channel);
        } else {
            const auto begin = taker.number<int>();
            answer_rows(begin, taker.number<int>(), channel);
        }
    }

  private:
    void answer_part(int part, MessageChannel& channel) {
        std::string bytes;
        if (input_->seek_subimage(part, 0)) {
            put_spec(bytes, input_->spec());
        }
        rows_of_tiles_.clear();
        channel.send(bytes);
    }

    void answer_rows(int begin, int end, MessageChannel& channel) {
        const OIIO::ImageSpec& spec = input_->spec();
        const std::size_t row = static_cast<std::size_t>(spec.width) * spec.pixel_bytes(true);
        std::vector<char> rows;
        bool is_read = true;
        if (spec.tile_width > 0) {
            if (rows_of_tiles_.empty()) {
                check_picture_size(*file_, spec, spec.nchannels, static_cast<double>(spec.pixel_bytes(true)));
                rows_of_tiles_.resize(row * static_cast<std::size_t>(spec.height));
                is_read = input_->read_image(input_->current_subimage(), 0, 0, spec.nchannels, OIIO::TypeUnknown,
                                             rows_of_tiles_.data());
            }
            const auto first = rows_of_tiles_.begin() + static_cast<std::ptrdiff_t>(row) * (begin - spec.y);
            rows.assign(first, first + static_cast<std::ptrdiff_t>(row) * (end - begin));
        } else {
            rows.resize(row * static_cast<std::size_t>(end - begin));
            is_read = input_->read_scanlines(input_->current_subimage(), 0, begin, end, 0, 0, spec.nchannels,
                                             OIIO::TypeUnknown, rows.data());
        }
        std::string head;
        append_bytes(head, is_read);
        put_text(head, input_->geterror());
        channel.send(head);
        channel.send({rows.data(), rows.size()});
    }

    const fs::path* file_;
    OIIO::ImageInput* input_;
    std::vector<char> rows_of_tiles_;
};

// Where the library is loaded late (.ci/late_library.cmake), this does it, and nothing else: what a library starts in
// the process that others are forked from, threads and locks, would not be whole in those.
void load_library() {
    OIIO::geterror();
}

void decode(const fs::path& file, MessageChannel& channel) {
    // Threads would be the library's, and it is one file.
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    const std::string asked = channel.receive();
    Taker hints(file, asked);
    const OpenPicture picture = open_picture_here(file, take_spec(hints));
    std::string bytes;
    append_bytes(bytes, picture.form);
    put_spec(bytes, picture.input->spec());
    channel.send(bytes);
    for (Decoder decoder(file, *picture.input);;) {
        decoder.answer(channel.receive(), channel);
    }
}

/// The asker's side, as the library's own readers are used.
class ConfinedInput final : public OIIO::ImageInput {
  public:
    ConfinedInput(MessageChannel channel, fs::path file, OIIO::ImageSpec spec)
        : channel_(std::move(channel)), file_(std::move(file)) {
        take(std::move(spec));
    }

    [[nodiscard]] const char* format_name() const override { return "confined"; }
    bool open(const std::string& /*name*/, OIIO::ImageSpec& /*spec*/) override { return false; }
    bool close() override { return true; }
    [[nodiscard]] int current_subimage() const override { return part_; }
    [[nodiscard]] int current_miplevel() const override { return 0; }

    bool seek_subimage(int subimage, int miplevel) override {
        if (miplevel != 0) {
            return false;
        }
        if (subimage != part_) {
            std::string wish;
            append_bytes(wish, Wish::part, subimage);
            channel_.send(wish);
            const std::string answer = channel_.receive();
            if (answer.empty()) {
                return false;
            }
            Taker taker(file_, answer);
            take(take_spec(taker));
            part_ = subimage;
        }
        return true;
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
        return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
    }

    bool read_native_scanlines(int subimage, int miplevel, int begin, int end, int /*z*/, void* data) override {
        if (!seek_subimage(subimage, miplevel)) {
            return false;
        }
        std::string wish;
        append_bytes(wish, Wish::rows, begin, end);
        channel_.send(wish);
        const std::string head = channel_.receive();
        Taker taker(file_, head);
        const bool is_read = taker.number<char>() != 0;
        const std::string_view complaint = taker.text();
        channel_.receive(static_cast<char*>(data), static_cast<std::size_t>(m_spec.width) * m_spec.pixel_bytes(true) *
                                                       static_cast<std::size_t>(end - begin));
        if (!complaint.empty()) {
            errorfmt("{}", complaint);
        }
        return is_read;
    }

  private:
    void take(OIIO::ImageSpec spec) {
        m_spec = std::move(spec);
        m_spec.tile_width = 0;
        m_spec.tile_height = 0;
        m_spec.tile_depth = 0;
    }

    MessageChannel channel_;
    fs::path file_;
    int part_ = 0;
};

}  // namespace

OpenPicture open_confined(const fs::path& file, const OIIO::ImageSpec& hints) {
    MessageChannel channel = start_confined(decode, file, file, load_library);
    std::string bytes;
    put_spec(bytes, hints);
    channel.send(bytes);
    const std::string answer = channel.receive();
    Taker taker(file, answer);
    const auto form = taker.number<int>();
    if (form < 0 || form > static_cast<int>(PictureForm::raw)) {
        taker.fail<int>();
    }
    OIIO::ImageSpec spec = take_spec(taker);
    return {.form = static_cast<PictureForm>(form),
            .input = std::make_unique<ConfinedInput>(std::move(channel), file, std::move(spec))};
}

}  // namespace lensproof::formats
