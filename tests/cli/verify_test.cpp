#include "run.h"

namespace crumple::cli::test {
namespace {

class Verify : public Cli {
   protected:
    Verify() {
        write("five.off", five_off);
        write("two.off", two_off);
    }
    Outcome verify(std::string_view list, const std::string& meshes = "five.off",
                   const std::string& options = "") const {
        write("list.txt", list);
        return crumple("verify " + meshes + " list.txt " + options);
    }
};

TEST_F(Verify, pairs_can_have_any_order) {
    for (const char* list : {five_pairs, "2 4\n0 1\n0 3\n", "# mine\n4 2\n1 0\n\n3 0\n"}) {
        const Outcome outcome = verify(list);
        EXPECT_EQ(outcome.status, 0) << list;
        EXPECT_EQ(outcome.out, "right: 3 pairs, 0 missing, 0 extra, 0 repeated\n");
        EXPECT_EQ(outcome.err, "");
    }
}

TEST_F(Verify, lists_in_every_format_can_be_verified) {
    for (const char* list : {"a.txt", "a.csv", "a.json", "a.npz"}) {
        ASSERT_EQ(crumple(std::string("detect five.off two.off --contacts -o ") + list).status, 0);
        EXPECT_EQ(crumple(std::string("verify five.off two.off ") + list).status, 0) << list;
        EXPECT_EQ(crumple(std::string("verify two.off five.off ") + list).status, 1) << list;
    }
}

TEST_F(Verify, mistakes_are_listed_by_kind) {
    const Outcome outcome = verify("0 1\n1 2\n0 1\n2 2\n0 3\n1 0\n2 9\n");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out,
              "wrong: 3 pairs, 1 missing, 3 extra, 1 repeated\nmissing 2 4\nextra 1 2\nextra 2 2\nextra 2 9\n"
              "repeated 0 1\n");
}

TEST_F(Verify, missing_extra_or_repeated_pair_fails_verification) {
    EXPECT_EQ(verify("0 1\n0 3\n").status, 1);
    EXPECT_EQ(verify("0 1\n0 3\n2 4\n3 4\n").status, 1);
    EXPECT_EQ(verify("0 1\n0 3\n2 4\n2 4\n").status, 1);
}

TEST_F(Verify, order_of_ids_matters_between_two_meshes) {
    EXPECT_EQ(verify("0 1\n2 0\n3 1\n4 0\n", "five.off two.off").status, 0);
    EXPECT_EQ(verify("1 0\n2 0\n3 1\n4 0\n", "five.off two.off").status, 1);
}

TEST_F(Verify, options_that_change_the_result_are_accepted) {
    EXPECT_EQ(verify("0 1\n0 3\n", "five.off", "--neighbours skip").status, 0);
    EXPECT_EQ(verify("0 1\n", "five.off", "--kind proper").status, 0);
    EXPECT_EQ(verify("0 1\n2 4\n", "five.off", "--weld --backend reference").status, 0);
    EXPECT_EQ(verify("2 4\n", "five.off", "--groups components --filter within").status, 0);
    EXPECT_EQ(verify(five_pairs, "five.off", "--part 1/1").status, 0);
}

TEST_F(Verify, only_the_first_few_mistakes_are_shown) {
    std::string list;
    for (int i = 100; i < 125; ++i) list += "0 " + std::to_string(i) + "\n";
    const std::string out = verify(list).out;
    EXPECT_TRUE(contains(out, "extra 0 109\nand 15 more extra\n")) << out;
    EXPECT_FALSE(contains(out, "extra 0 110")) << out;
}

TEST_F(Verify, error_names_the_line_that_is_no_pair) {
    const Outcome outcome = verify("0 1\n0 x\n");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(is_error_line(outcome.err)) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "list.txt") && contains(outcome.err, "line 2")) << outcome.err;
}

}  // namespace
}  // namespace crumple::cli::test
