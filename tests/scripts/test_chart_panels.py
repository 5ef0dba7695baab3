"""What all charts share: one look for each method, and labels at the ends of lines."""

import itertools
import math
import unittest

from drawing import DrawingTest, lines_of

from lib.records.formats import listed

GREY_APART = 0.07  # least difference in lightness of two lines that differ in nothing else


class Looks(DrawingTest):
    def look(self, name, *tolerance):
        return self.module("lib.pages.chart_panels").look(listed(name), *tolerance)

    def lightness(self, look):
        red, green, blue = self.module("lib.pages.chart_panels").to_rgb(look["color"])
        return 0.299 * red + 0.587 * green + 0.114 * blue

    def drawn(self):
        """Returns the forms that stand beside each other in a chart, as lists of (method, tolerance)."""
        charts, longruns, limits = map(self.module, (
            f"studies.{name}.charts" for name in ("accuracy", "longruns", "limits")))
        yield [tuple(form) for form in charts.WORK_PRECISION]
        yield [(name, 1e-13) for name in charts.AGAINST_N]
        yield [(name, 1e-13) for name in limits.DRAWN]
        for names in (longruns.AGAINST_COST, longruns.AGAINST_TIME):
            yield [(name[:-6], 1e-13) if name.endswith("_tight") else (name, 1e-8 if name == "elp6" else 1e-13)
                   for name in names]

    def test_each_line_of_a_chart_has_its_own_look_also_in_grey(self):
        for forms in self.drawn():
            self.assertLessEqual(len(forms), 7)
            for one, other in itertools.combinations(forms, 2):
                with self.subTest(one=one, other=other):
                    looks = [self.look(*form) for form in (one, other)]
                    same = all(looks[0][key] == looks[1][key] for key in ("linestyle", "marker"))
                    self.assertTrue(not same or abs(self.lightness(looks[0]) - self.lightness(looks[1])) > GREY_APART)
        self.assertEqual(self.look("group2"), self.look("group2_frame"))  # control: one method, one look

    def test_lines_say_what_is_kept_and_are_lighter_where_it_is_less(self):
        for name, tolerance, line in (("group2", 1e-13, "-"), ("group2", 1e-7, ":"), ("elp6", 1e-13, "-"),
                                      ("elp6", 1e-8, "--"), ("magnus5", 1e-8, "--"), ("rk4", 1e-13, ":"),
                                      ("rk4_projected", 1e-13, "--")):
            self.assertEqual(self.look(name, tolerance)["linestyle"], line, name)
        for name, loose, lighter in (("elp6", 1e-8, True), ("group2", 1e-7, True), ("magnus5", 1e-8, False)):
            self.assertEqual(self.lightness(self.look(name, loose)) > self.lightness(self.look(name)), lighter, name)


class Ticks(DrawingTest):
    def test_an_axis_has_two_figures_at_least_and_powers_of_ten_alone_where_they_are_enough(self):
        module = self.module("lib.pages.chart_panels")
        for low, high, seen in ((3e-10, 3e-9, 2), (1.2, 8.0, 2), (1e-12, 1e-3, 5)):
            with module.own_style():
                figure, ((axes,),) = module.new_figure("Title", 1, 1, 5.0)
                module.logarithmic(axes)
                axes.set_ylim(low, high)
                figure.canvas.draw()
            ticks = [each for each in axes.get_yticks() if low <= each <= high]
            self.assertGreaterEqual(len(ticks), seen)
            powers = [abs(math.log10(each) - round(math.log10(each))) < 1e-9 for each in ticks]
            self.assertEqual(all(powers), seen == 5)
            self.assertTrue(all(label.get_text() for label in axes.get_yticklabels()))


class Labels(DrawingTest):
    def labelled(self, ends, **options):
        """Returns the panel of some lines to the ends {label: (x, y)}, and the places of labels in points."""
        module = self.module("lib.pages.chart_panels")
        with module.own_style():
            _, ((axes,),) = module.new_figure("Title", 1, 1, 5.0, labels=ends)
            axes.set(xlim=(0, 10), ylim=(0, 10))
            for label, end in ends.items():
                axes.plot((0, end[0]), (0, end[1]), label=label)
            module.label_ends(axes, [(end, label, "black") for label, end in ends.items()], **options)
        width, height = (72 * size / axes.figure.dpi for size in (axes.bbox.width, axes.bbox.height))
        return axes, {text.get_text(): (text.xy[0] * width, text.xy[1] * height) for text in axes.texts}

    def leaders(self, axes):
        return [line for line in axes.lines if line.get_label() == "_leader"]

    def test_close_labels_are_moved_apart_and_led_to_their_lines(self):
        axes, places = self.labelled({"a": (10, 5), "b": (10, 5.01), "c": (10, 9)})
        self.assertGreater(places["b"][1] - places["a"][1], self.module("lib.pages.chart_panels").LABEL_SIZE)
        self.assertEqual((len(self.leaders(axes)), set(lines_of(axes))), (2, {"a", "b", "c"}))
        axes, _ = self.labelled({"a": (10, 2), "b": (10, 5), "c": (10, 9)})
        self.assertEqual(self.leaders(axes), [])

    def test_a_line_that_ends_early_has_its_label_there(self):
        ends = {"a": (10, 5), "b": (4, 5)}
        _, places = self.labelled(ends)
        self.assertAlmostEqual(places["b"][0] / places["a"][0], 0.4)
        axes, places = self.labelled(ends, in_one_column=True)
        self.assertEqual((places["a"][0], len(self.leaders(axes))), (places["b"][0], 2))


if __name__ == "__main__":
    unittest.main()
