%
o1000
#1=1.
while[#1 lt 3]do1
g1 x#1 f100.
#1=#1+1.
end1
m30
%
