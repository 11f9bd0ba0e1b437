# Makes Android's string resources and Swift's Localizable.strings from bindings/texts: `perl bindings/texts.pl FOLDER` writes
# them below FOLDER, a copy of this repository's or an empty one. It refuses a translation with a name or a placeholder that
# English does not have.
use strict;
use warnings;

my ($folder) = @ARGV or die "usage: bindings/texts.pl FOLDER\n";
my $generated = 'made by bindings/generate.sh from bindings/texts';

sub read_table {
    my ($file) = @_;
    open my $in, '<', $file or die "$file: $!\n";
    my (@names, %texts);
    while (<$in>) {
        next if /^#|^\s*$/;
        my ($name, $text) = /^([a-z_]+) = (\S(?:.*\S)?)$/ or die "$file:$.: expected `name = text`\n";
        die "$file:$.: $name is there twice\n" if exists $texts{$name};
        die "$file:$.: a % sign, a backslash or a quote would need care here\n" if $text =~ /[%\\"]/;
        push @names, $name;
        $texts{$name} = $text;
    }
    return (\@names, \%texts);
}

# placeholders by name: kind, and position in the English text
sub placeholders {
    my ($text, $place) = @_;
    my ($n, %found) = 0;
    while ($text =~ /\{(\w+):(text|int|\.\d)\}/g) {
        die "$place: {$1} is there twice\n" if $found{$1};
        $found{$1} = [$2, ++$n];
    }
    die "$place: a brace that is no placeholder\n" if ($text =~ s/\{\w+:(?:text|int|\.\d)\}//gr) =~ /[{}]/;
    return \%found;
}

sub written {
    my ($file, $text) = @_;
    my $path = '';
    for my $part ("$folder/$file" =~ m{([^/]*/)}g) { $path .= $part; mkdir $path }
    open my $out, '>', "$folder/$file" or die "$folder/$file: $!\n";
    print $out $text;
    close $out;
}

sub formatted {
    my ($text, $kinds, $english) = @_;
    return $text =~ s/\{(\w+):[^}]*\}/'%' . $english->{$1}[1] . '$' . ($kinds->{$english->{$1}[0]} || $english->{$1}[0] . 'f')/ger;
}

my ($names, $english) = read_table('bindings/texts/en.txt');
my %expected = map { $_ => placeholders($english->{$_}, "en.txt: $_") } @$names;
for my $file (sort glob 'bindings/texts/*.txt') {
    my ($language, $region) = $file =~ m{/([a-z]{2,3})(?:-([A-Z]{2}))?\.txt$} or die "$file: expected a language's code, as de.txt or pt-BR.txt\n";
    my (undef, $texts) = read_table($file);
    for my $name (sort keys %$texts) {
        die "$file: $name is not in en.txt\n" unless $expected{$name};
        my $found = placeholders($texts->{$name}, "$file: $name");
        my ($ours, $theirs) = map { my $set = $_; join ' ', map { "{$_:$set->{$_}[0]}" } sort keys %$set } $found, $expected{$name};
        die "$file: $name has the placeholders '$ours', and English '$theirs'\n" if $ours ne $theirs;
    }
    my @here = grep { exists $texts->{$_} } @$names;
    my $android = join '', map {
        my $text = formatted($texts->{$_}, { text => 's', int => 'd' }, $expected{$_});
        $text =~ s/&/&amp;/g; $text =~ s/</&lt;/g; $text =~ s/'/\\'/g; $text =~ s/^([@?])/\\$1/;
        '    <string name="magcomp_' . s/^android_//r . qq(">$text</string>\n)
    } grep { !/^ios_/ } @here;
    my $values = $language eq 'en' && !$region ? 'values' : "values-$language" . ($region ? "-r$region" : '');
    written("android/library/src/main/res/$values/strings.xml", qq(<?xml version="1.0" encoding="utf-8"?>\n<!-- $generated -->\n<resources>\n$android</resources>\n));
    # Android looks in the English ones for a string that is left out, Apple's systems do not
    my $swift = join '', map { qq("$_" = ") . formatted($texts->{$_} // $english->{$_}, { text => '@', int => 'lld' }, $expected{$_}) . qq(";\n) } grep { !/^android_/ } @$names;
    my $project = $language . ($region ? "-$region" : '');
    written("ios/Sources/Magcomp/Resources/$project.lproj/Localizable.strings", "/* $generated */\n$swift");
}

# the same in Swift, for an app that was copied without the package's bundle
written('ios/Sources/Magcomp/EnglishTexts.swift', "// swift-format-ignore-file\n// $generated\n\n"
    . "/// The package's English `Localizable.strings`.\nlet englishTexts: [String: String] = [\n"
    . join('', map { qq(    "$_": ") . formatted($english->{$_}, { text => '@', int => 'lld' }, $expected{$_}) . qq(",\n) } grep { !/^android_/ } @$names) . "]\n");

# what Android's own tools make of the resources, for Maven's build, which has none of them
my @android = map { s/^android_//r } grep { !/^ios_/ } @$names;
my $id = 0x7f0e0000;
my $fields = join '', map { sprintf "        static int magcomp_%s = 0x%x;\n", $_, $id++ } @android;
written('android/library/src/maven/java/org/magcomp/R.java', <<"JAVA");
package org.magcomp;

/** Stands in for the class that Android's tools make of the resources; $generated. No artifact has it. */
final class R {
    static final class string {
$fields    }
}
JAVA
written('android/aar/src/main/aar/R.txt', join '', map { "int string magcomp_$_ 0x0\n" } @android);
