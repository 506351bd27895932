// Runs a reader on every file of a folder, as libFuzzer does with a corpus, or on mutants of those files: for builds
// without libFuzzer.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "tests/fuzz/replayed_readers.h"
#include "tests/test_folder.h"

namespace {

using Reader = void (*)(const std::string& bytes);

class Mutator {
    unsigned below(std::size_t end) { return static_cast<unsigned>(random_() % std::max<std::size_t>(1, end)); }

    template <class List>
    const std::string& any(const List& list) {
        return list[below(list.size())];
    }

  public:
    explicit Mutator(const std::vector<std::string>& corpus) : corpus_(&corpus) {}

    /// Mutant `number` of all that there are: the same in every run.
    std::string mutant(unsigned number) {
        random_.seed(number);
        std::string bytes = any(*corpus_);
        for (unsigned change = below(8) + 1; change > 0; --change) {
            mutate(bytes);
        }
        return bytes;
    }

  private:
    void mutate(std::string& bytes) {
        static const std::array<std::string, 12> kNumbers = {"0",    "-1",  "1e308", "nan",        "-inf", "1e-308",
                                                             "0.5e", "1e9", "-0",    "4294967296", "",     "\xff"};
        const std::size_t at = below(bytes.size());
        const std::size_t length = std::min<std::size_t>(below(below(4) == 0 ? 4096 : 16) + 1, bytes.size() - at);
        switch (below(8)) {
            case 0:  // a bit
                if (!bytes.empty()) {
                    bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
                }
                return;
            case 1:  // bytes at the ends of their range, as counts and offsets have them
                std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, below(2) == 0 ? '\0' : '\xff');
                return;
            case 2:
                bytes.resize(at);
                return;
            case 3:
                bytes.erase(at, length);
                return;
            case 4:
                bytes.insert(at, bytes.substr(at, length));
                return;
            case 5: {  // a part of another file of the kind
                const std::string& other = any(*corpus_);
                bytes.insert(at, other.substr(below(other.size()), length));
                return;
            }
            case 6:
                bytes.insert(at, any(kNumbers));
                return;
            default: {  // another number where one stands
                constexpr const char* kDigits = "0123456789.+-eE";
                const std::size_t begin = bytes.find_first_of("0123456789", at);
                if (begin != std::string::npos) {
                    const std::size_t end = bytes.find_first_not_of(kDigits, begin);
                    bytes.replace(begin, end == std::string::npos ? end : end - begin, any(kNumbers));
                }
            }
        }
    }

    const std::vector<std::string>* corpus_;
    std::mt19937 random_;
};

/// Memory of this process and of those forked from it.
unsigned& shared_number() {
    void* page = ::mmap(nullptr, sizeof(unsigned), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return *static_cast<unsigned*>(page);
}

/// In processes of their own, each of which goes on until one of the mutants ends it: by a signal, by taking ten
/// seconds, or by 4 GiB. Those are left in the working folder. Returns how many they are.
int use_mutants(const std::string& name, Reader use, const std::vector<std::string>& corpus, unsigned first,
                unsigned count) {
    const lensproof::TestFolder temporary;  // for readers of files, which processes that are ended leave behind
    ::setenv("TMPDIR", temporary.path().c_str(), 1);
    unsigned& current = shared_number();
    int failures = 0;
    for (current = first; current < first + count; ++current) {
        std::fflush(stdout);
        const ::pid_t child = ::fork();
        if (child == 0) {
#ifndef __SANITIZE_ADDRESS__
            const ::rlimit memory{.rlim_cur = 1UL << 32, .rlim_max = 1UL << 32};
            ::setrlimit(RLIMIT_AS, &memory);
#endif
            Mutator mutator(corpus);
            for (; current < first + count; ++current) {
                ::alarm(10);
                use(mutator.mutant(current));
            }
            ::_exit(0);  // libraries' own endings wait for threads that a fork does not have
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        if (status != 0) {
            ++failures;
            const std::string file = name + "-mutant-" + std::to_string(current);
            const std::string bytes = Mutator(corpus).mutant(current);
            if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
                std::fwrite(bytes.data(), 1, bytes.size(), out);
                std::fclose(out);
            }
            std::printf("mutant %u ended its reader (%s %d), see %s\n", current,
                        WIFSIGNALED(status) ? "signal" : "status",
                        WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), file.c_str());
        }
    }
    return failures;
}

int replay(int argc, char** argv) {
    const auto& readers = lensproof::replayed_readers();
    const auto reader = argc > 1 ? readers.find(argv[1]) : readers.end();
    if (argc < 3 || argc > 5 || reader == readers.end()) {
        std::fprintf(stderr, "usage: %s READER FOLDER [MUTANTS [FIRST]]\n", argv[0]);
        return 2;
    }
    const Reader use = reader->second;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[2])) {
        files.push_back(entry.path());
    }
    std::ranges::sort(files);
    std::vector<std::string> corpus(files.size());
    std::ranges::transform(files, corpus.begin(), lensproof::read_file);
    int failures = 0;
    if (argc > 3) {
        const auto number = [&](int i) {
            return static_cast<unsigned>(argc > i ? std::strtoul(argv[i], nullptr, 10) : 0);
        };
        failures = use_mutants(reader->first, use, corpus, number(4), number(3));
        std::printf("%u mutants, %d failures\n", number(3), failures);
    } else {
        for (std::size_t i = 0; i < files.size(); ++i) {
            std::printf("%s\n", files[i].filename().c_str());
            std::fflush(stdout);  // the last name printed is the one that crashed
            use(corpus[i]);
        }
        std::printf("%zu files\n", files.size());
    }
    return files.empty() || failures > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return replay(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
